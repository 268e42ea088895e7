# shellcheck shell=sh
# chance.sh - numbers drawn from a seed that is printed, so that what was tried
# can be tried again; read with "."

# draw_from SEED: from now on; without one from the time
draw_from()
{
    seed=${1:-$(date +%s)}
    echo "seed $seed"
    state=$((seed % 2147483647))
}

# any N: a number below N, in $any (no subshell: the state would stay there)
any()
{
    # Park and Miller's, which fits 64 bits
    state=$(((state * 48271 + 11) % 2147483647))
    any=$((state / 7 % $1))
}

# one_of WORD...: in $word
one_of()
{
    any $#
    shift "$any"
    word=$1
}
