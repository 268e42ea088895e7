# books.awk - fill shelves with books
#
# Each line of the table:   x0 x1  y0  z0  height  fill
# is one shelf: books stand side by side from x0 towards x1 with their backs at
# y0, their feet at z0, at most height tall; fill (0 to 1) is how much of the
# shelf is taken.  The output is a table for boxes.awk.
# The numbers come from a generator of our own, so every awk makes the same
# books.

function uniform()          # 0 <= u < 1; Lehmer's generator
{
    state = state * 16807 % 2147483647
    return state / 2147483647
}

BEGIN {
    state = 20261
    ncolours = split("oxblood moss navy ochre ivory slate umber", colour, " ")
}

/^#/ || NF == 0 { next }

{
    end = $1 + ($2 - $1) * $6
    for (x = $1; ; x += w + .001) {
        w = .018 + .035 * uniform()
        if (x + w > end)
            break
        h = $5 * (.62 + .33 * uniform())
        d = .15 + .07 * uniform()
        c = colour[1 + int(ncolours * uniform())]
        print c, "book" ++n, x, $3, $4, x + w, $3 + d, $4 + h
        if (uniform() < .03)    # a gap, where one is being read
            x += .05
    }
}
