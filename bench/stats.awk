# stats.awk - one line of a statistics file (radsubmit --stats)
#
# awk -v head="words" -f stats.awk FILE.json prints, after those words:
#  1 wall_s          2 estimate_s        3 rays             4 primary_rays
#  5 speculative     6 ambient_values    7 ambient_redundant
#  8 the worker that waited longest for base lines [s]
#  9 base_line_bytes 10 base_line_pixels (- where the file has none)
# 11 units           12, 13 correlation of the units' estimates with their
# cpu_s and with their rays (- where estimates do not differ)
# 14 render_s        15 processor time of a ray of the units [s]
# The file is as jansson writes it with an indent of 1: a key a line.
function number(line)
{
    sub(/^[^:]*: */, "", line)
    return line + 0
}

# Correlation of estimates with what x sums: n, the sums and the products.
function correlation(x, xx, xe,   a, b)
{
    a = units * see - se * se
    b = units * xx - x * x
    if (units < 3 || a <= 1e-9 * units * see || b <= 0)
        return "-"
    return sprintf("%.4f", (units * xe - se * x) / sqrt(a * b))
}

function end_unit()
{
    units++
    se += e; see += e * e
    sc += c; scc += c * c; sec += e * c
    sr += r; srr += r * r; ser += e * r
}

BEGIN { line_bytes = line_pixels = "-" }
/^ "[a-z]+": [{[]/ { split($0, part, "\""); section = part[2]; next }
section == "time" && /"wall_s"/ { wall = number($0) }
section == "time" && /"estimate_s"/ { estimate = number($0) }
section == "time" && /"render_s"/ { render = number($0) }
section == "totals" && /"rays"/ { rays = number($0) }
section == "totals" && /"dropped_rays"/ { rays += number($0) }
section == "totals" && /"primary_rays"/ { primary = number($0) }
section == "totals" && /"speculative_rays"/ { speculative = number($0) }
section == "totals" && /"ambient_values"/ { values = number($0) }
section == "totals" && /"ambient_redundant"/ { redundant = number($0) }
section == "totals" && /"base_line_bytes"/ { line_bytes = number($0) }
section == "totals" && /"base_line_pixels"/ { line_pixels = number($0) }
section == "workers" && /"threads"/ { threads = number($0) }
section == "workers" && /"wait_base_line_s"/ {
    w = number($0) / (threads > 0 ? threads : 1)
    if (w > wait)
        wait = w
}
section == "units" && /"rays"/ { r = number($0) }
section == "units" && /"estimate"/ { e = number($0) }
section == "units" && /"cpu_s"/ { c = number($0) }
section == "units" && /^  }/ { end_unit() }
END {
    cost = sr > 0 ? sc / sr : 0
    printf "%s %.6g %.6g %.0f %.0f %.0f %.0f %.6g %.6g %s %s %d %s %s %.6g %.6g\n",
        head, wall, estimate, rays, primary, speculative, values, redundant,
        wait, line_bytes, line_pixels, units, correlation(sc, scc, sec),
        correlation(sr, srr, ser), render, cost
}
