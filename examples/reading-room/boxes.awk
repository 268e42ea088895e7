# boxes.awk - turn a table of boxes into polygons
#
# Each line of the table:   material  name  x0 y0 z0  x1 y1 z1
# gives six polygons named name.1 to name.6, their normals outward.
# Empty lines and lines that start with # are passed over.

function face(n, a, b, c, d)
{
    printf "%s polygon %s.%d\n0 0 12\n%s\n%s\n%s\n%s\n\n", mat, name, n, \
        corner[a], corner[b], corner[c], corner[d]
}

/^#/ || NF == 0 { next }

NF != 8 {
    printf "boxes.awk: %s:%d: 8 words wanted, %d found\n", \
        FILENAME, FNR, NF > "/dev/stderr"
    exit 1
}

{
    mat = $1; name = $2
    # corner k: bit 0 chooses x, bit 1 y, bit 2 z
    for (k = 0; k < 8; k++)
        corner[k] = (k % 2 ? $6 : $3) " " (int(k / 2) % 2 ? $7 : $4) " " \
            (k >= 4 ? $8 : $5)
    face(1, 0, 2, 3, 1)    # bottom
    face(2, 4, 5, 7, 6)    # top
    face(3, 0, 1, 5, 4)    # front, towards -y
    face(4, 2, 6, 7, 3)    # back
    face(5, 0, 4, 6, 2)    # left, towards -x
    face(6, 1, 3, 7, 5)    # right
}
