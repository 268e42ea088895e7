#!/bin/sh
# materials.sh - scenes of one family of materials each: rays whose radiance is
# known, and copies that look like what they are copies of
#
# NAME.rays holds the options in its first line, and then for each ray its origin
# and direction and the radiance that Radiance 6.1's rtrace gave for NAME.rad
# behind brdf_room.rad.  NAME.bands holds the same with a number for each band of
# wavelengths.
set -u
radscene=$top_builddir/radscene
tmp=$(mktemp -d) || exit 99
trap 'rm -rf "$tmp"' EXIT
cd "$top_srcdir/tests/scenes" || exit 99
unset RAYPATH
failed=0

# compare NAME FILE FILE [N]: radiances, N or three numbers a line, are within 1e-4
# of the line's largest
compare() {
    paste -d' ' "$2" "$3" | awk -v name="$1" -v n="${4:-3}" '
        function abs(x) { return x < 0 ? -x : x }
        NF != 2 * n { bad++; next }
        {
            m = 0
            for (i = 1; i <= 2 * n; i++)
                if (abs($i) > m)
                    m = abs($i)
            lit += m > 0
            for (i = 1; i <= n; i++)
                if (!(abs($i - $(i + n)) <= 1e-4 * m)) {
                    if (!bad++)
                        print name ": ray " NR ": " $0
                    next
                }
        }
        END {
            if (bad || lit < 20) {
                print name ": " bad + 0 " of " NR " rays differ, " lit " lit"
                exit 1
            }
        }' || failed=1
}

for name in aniso ashik brdf brdf_data brtd bsdf fprism functions lamps lights \
    phong prism spectra tables wgmd; do
    read -r options <$name.rays
    sed 1d $name.rays | cut -d' ' -f1-6 >"$tmp/rays"
    sed 1d $name.rays | cut -d' ' -f8-10 >"$tmp/expected"
    # shellcheck disable=SC2086
    $radscene rays $options brdf_room.rad $name.rad <"$tmp/rays" \
        >"$tmp/got" || failed=1
    compare $name "$tmp/expected" "$tmp/got"
done

# Twenty bands of spectra.
read -r options <spectra.bands
sed 1d spectra.bands | cut -d' ' -f1-6 >"$tmp/rays"
sed 1d spectra.bands | cut -d' ' -f7- >"$tmp/expected"
# shellcheck disable=SC2086
$radscene rays $options brdf_room.rad spectra.rad <"$tmp/rays" >"$tmp/got" ||
    failed=1
compare "spectra in bands" "$tmp/expected" "$tmp/got" 20

# Where all is given in red, green and blue, six bands are these, in steps.  (Not
# with functions that ask for the colour of a material.)
for name in aniso ashik brdf_data brtd bsdf fprism functions lamps lights phong \
    prism tables wgmd; do
    read -r options <$name.rays
    sed 1d $name.rays | cut -d' ' -f1-6 >"$tmp/rays"
    sed 1d $name.rays | cut -d' ' -f8-10 |
        awk '{ print $1, $1, $1, $2, $2, $3 }' >"$tmp/expected"
    # shellcheck disable=SC2086
    $radscene rays $options -cs 6 -co+ brdf_room.rad $name.rad <"$tmp/rays" \
        >"$tmp/got" || failed=1
    compare "$name in bands" "$tmp/expected" "$tmp/got" 6
done

# A copy turned a quarter about the zenith, where the only light is, and rays
# turned with it.
cat >"$tmp/sun.rad" <<'END'
void light sunshine 0 0 3 1e4 1e4 1e4
sunshine source sun 0 0 4 0 0 1 1
END
cp ./*.cal ./*.dat ./*.fnt ./*.hdr ./*.xml "$tmp"
for name in aniso ashik brdf brdf_data brtd bsdf fprism prism tables wgmd; do
    read -r options <$name.rays
    sed 1d $name.rays | cut -d' ' -f1-6 >"$tmp/rays"
    awk '{ print -$2, $1, $3, -$5, $4, $6 }' "$tmp/rays" >"$tmp/turned"
    $radscene freeze $name.rad >"$tmp/$name.oct" || failed=1
    printf 'void instance copy 3 %s -rz 90 0 0\n' $name.oct >"$tmp/copy.rad"
    # what a copy holds relays no light sources
    # shellcheck disable=SC2086
    $radscene rays $options -dr 0 "$tmp/sun.rad" $name.rad <"$tmp/rays" \
        >"$tmp/expected" || failed=1
    # shellcheck disable=SC2086
    (cd "$tmp" && $radscene rays $options -dr 0 sun.rad copy.rad <turned) \
        >"$tmp/got" || failed=1
    compare "$name copied" "$tmp/expected" "$tmp/got"
done
exit $failed
