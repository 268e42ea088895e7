# hosts.awk - the tables of hosts.sh, from the lines of its runs
#
# Reads two files: what was simulated, in lines of table, row, workers and
# seconds; and the runs: table, row, workers, then what stats.awk tells.  Variables: tables,
# workers, windows as hosts.sh has them; share: workstations of the first
# table; most: of the table of estimates; frames of the animation.
function median(key, field,   n, i, j, t, v)
{
    n = count[key]
    for (i = 1; i <= n; i++) {
        v[i] = what[key, i, field]
        if (v[i] == "-")
            return "-"
        for (j = i; j > 1 && v[j] + 0 < v[j - 1] + 0; j--) {
            t = v[j]; v[j] = v[j - 1]; v[j - 1] = t
        }
    }
    if (n == 0)
        return "-"
    return n % 2 ? v[(n + 1) / 2] : (v[n / 2] + v[n / 2 + 1]) / 2
}

# A number by its format, or "-" as wide.
function show(format, v,   width)
{
    width = format
    gsub(/[^0-9.]/, "", width)
    return v == "-" ? sprintf("%" int(width) "s", "-") : sprintf(format, v)
}

function over(a, b)
{
    return a == "-" || b == "-" || b == 0 ? "-" : a / b
}

function times(a, b)
{
    return a == "-" ? "-" : a * b
}

# How many times faster than the baseline.
function speed_up(key)
{
    return over(base, median(key, 1))
}

# The same at even cost of rays.
function even(key)
{
    return over(even_base, median(key, 16))
}

# What the baseline of the next speed-ups is.
function take_base(key)
{
    base = median(key, 1)
    even_base = median(key, 16)
}

function title(text)
{
    printf "\n%s\n", text
}

function head_of_workers(   i)
{
    for (i = 1; i <= nworkers; i++)
        printf "%9d%7s", worker[i], "even"
    print ""
}

function row_of_speed_ups(label, table, row,   i, key)
{
    printf "%-20s", label
    for (i = 1; i <= nworkers; i++) {
        key = table " " row " " worker[i]
        printf "%s%s", show("%9.2f", speed_up(key)), show("%7.2f", even(key))
    }
    print ""
}

function share_table(   i, a, b, saved)
{
    title("Sharing of ambient values, " share " workstations: million rays" \
        " and seconds, with and without")
    print "   windows     rays  seconds   rays -  seconds -    saved" \
        " redundant"
    for (i = 1; i <= nwindows; i++) {
        a = "share " window[i] " " share
        b = "alone " window[i] " " share
        saved = over(median(a, 3), median(b, 3))
        if (saved != "-")
            saved = 100 * (1 - saved)
        printf "%10d%s%s%s  %s%s %%%s %%\n", window[i],
            show("%9.3f", times(median(a, 3), 1e-6)),
            show("%9.2f", median(a, 1)),
            show("%9.3f", times(median(b, 3), 1e-6)),
            show("%9.2f", median(b, 1)), show("%7.1f", saved),
            show("%8.1f", times(over(median(a, 7), median(a, 6)), 100))
    }
}

function estimate_table(   i, v, n)
{
    title("Estimates of bars: correlation with their measured cost, " most \
        " workstations")
    print "                    with seconds  with rays  bars  estimate took" \
        " [s]"
    n = split("5a 5b 20a 20b", v, " ")
    for (i = 1; i <= n; i++) {
        key = "estimate " v[i] " " most
        printf "%-20s%s%s%s%s\n", v[i], show("%12.3f", median(key, 12)),
            show("%11.3f", median(key, 13)), show("%6.0f", median(key, 11)),
            show("%15.3f", median(key, 2))
    }
}

function static_table(   i, v, n)
{
    title("Speed-up of static without balancing, by estimate, and at even cost" \
        " of rays")
    printf "%-20s", "workstations"
    head_of_workers()
    n = split("uniform 5a 5b 20a 20b optimum", v, " ")
    for (i = 1; i <= n; i++)
        row_of_speed_ups(v[i], "static", v[i])
}

# The number of windows that is fastest with n workers; 0: none was measured.
function best_windows(n,   i, t, best, least)
{
    for (i = 1; i <= nwindows; i++) {
        t = median("windows " window[i] " " n, 1)
        if (t != "-" && (!best || t < least)) {
            best = window[i]
            least = t
        }
    }
    return best
}

function way_line(label, key, n,   t)
{
    t = median(key, 1)
    printf "%-14s%5d%s%s%s%s%s%s%s%s%s%s\n", label, n, show("%9.2f", t),
        show("%9.2f", over(base, t)),
        show("%6.2f", even(key)),
        show("%7.1f", times(over(over(base, t),
        n), 100)), show("%9.3f", times(median(key, 3), 1e-6)),
        show("%9.0f", median(key, 4)),
        show("%7.2f", times(over(median(key, 5), median(key, 4)), 100)),
        show("%7.2f", times(over(median(key, 8), t), 100)),
        show("%7.1f", times(over(median(key, 7), median(key, 6)), 100)),
        show("%7.1f", over(median(key, 9), median(key, 10)))
}

function ways_table(   i, n, b)
{
    title("Ways to share (static with balancing): seconds, speed-up, the same" \
        " at even cost of\nrays, efficiency [%], million rays, primary rays," \
        " speculative ones [% of them], longest wait of\na worker for base" \
        " lines [% of the time],"  \
        " redundant ambient values [%], bytes a base-line pixel")
    printf "%-14s%5s%9s%9s%6s%7s%9s%9s%7s%7s%7s%7s\n", "", "hosts",
        "seconds", "speed-up", "even", "eff", "rays", "primary", "spec", \
        "wait", "redun", "bytes"
    way_line("one worker", "base auto 1", 1)
    for (i = 1; i <= nworkers; i++) {
        n = worker[i]
        way_line("static", "ways static " n, n)
        way_line("scanbar", "ways scanbar " n, n)
        if ((b = best_windows(n)) > 0)
            way_line(b " windows", "windows " b " " n, n)
        way_line("auto", "ways auto " n, n)
    }
}

function windows_table(   i)
{
    title("Speed-up of windows, by their number, and at even cost of rays")
    printf "%-20s", "workstations"
    head_of_workers()
    for (i = 1; i <= nwindows; i++)
        row_of_speed_ups(window[i] " windows", "windows", window[i])
}

# The simulator knows one cost of a ray: that of the baseline.
function sim_line(label, key, n,   s, t)
{
    t = over(base, even(key))
    s = key in simulated ? simulated[key] : "-"
    printf "%-14s%5d%s%s%s%s\n", label, n, show("%10.2f", median(key, 1)),
        show("%10.2f", t), show("%10.2f", s), show("%10.2f", over(s, t))
}

function sim_table(   i, j, n)
{
    title("Seconds as measured, at even cost of rays, and simulated" \
        " (bench/sim); simulated\nover even")
    printf "%-14s%5s%10s%10s%10s%10s\n", "", "hosts", "measured", "even",
        "simulated", "ratio"
    for (i = 1; i <= nworkers; i++) {
        n = worker[i]
        sim_line("static", "ways static " n, n)
        sim_line("scanbar", "ways scanbar " n, n)
        for (j = 1; j <= nwindows; j++)
            sim_line(window[j] " windows", "windows " window[j] " " n, n)
        sim_line("auto", "ways auto " n, n)
    }
}

function animation_table(   i, v, n)
{
    title("Animation of " frames " views: speed-up over one worker, frame by" \
        " frame, nothing kept,\nand at even cost of rays")
    take_base("animation fresh 1")
    printf "one worker, frame by frame, nothing kept %s s\n",
        show("%9.2f", base)
    printf "one worker, all kept %s s, %s times\n",
        show("%9.2f", median("animation whole 1", 1)),
        show("%.2f", speed_up("animation whole 1"))
    printf "%-20s", "workstations"
    head_of_workers()
    row_of_speed_ups("frame by frame", "animation", "fresh")
    n = split("static scanbar window auto", v, " ")
    for (i = 1; i <= n; i++)
        row_of_speed_ups("whole, " v[i], "animation", v[i])
    take_base("base auto 1")
}

FILENAME ~ /simulated$/ {
    simulated[$1 " " $2 " " $3] = $4
    next
}
{
    key = $1 " " $2 " " $3
    n = ++count[key]
    for (i = 4; i <= NF; i++)
        what[key, n, i - 3] = $i
    # seconds, as if a ray took a microsecond of processor time
    what[key, n, 16] = $18 > 0 ? 1e-6 * $4 / $18 : "-"
}
END {
    nworkers = split(workers, worker, " ")
    nwindows = split(windows, window, " ")
    take_base("base auto 1")
    printf "One worker: %s s, %s million rays\n", show("%.2f", base),
        show("%.3f", times(median("base auto 1", 3), 1e-6))
    n = split(tables, table, ",")
    for (i = 1; i <= n; i++) {
        if (table[i] == "share") share_table()
        if (table[i] == "estimate") estimate_table()
        if (table[i] == "static") static_table()
        if (table[i] == "ways") ways_table()
        if (table[i] == "windows") windows_table()
        if (table[i] == "sim") sim_table()
        if (table[i] == "animation") animation_table()
    }
}
