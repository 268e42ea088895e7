# Draws what speed-error.awk left in the folder dir; x: seconds or rays; type:
# png or svg; out: the file.
scenes = system(sprintf("cat '%s/scenes'", dir))
nlines = int(system(sprintf("grep -c . '%s/lines'", dir)))
line(j) = system(sprintf("sed -n '%dp' '%s/lines' | cut -f1", j, dir))
name(j) = system(sprintf("sed -n '%dp' '%s/lines' | cut -f2", j, dir))
file(s, j) = sprintf("%s/%s-%s.dat", dir, s, line(j))
there(s, j) = int(system(sprintf("grep -c . '%s' 2>/dev/null || :", file(s, j))))
n = words(scenes)
if (type eq "png") {
    set terminal pngcairo size 300 * n + 60, 640 font "sans,9"
} else {
    set terminal svg size 300 * n + 60, 640 font "sans,11" background "white"
}
set output out
set logscale xy
set grid
set key bottom left samplen 2
set tmargin 2
set rmargin 2
column = x eq "rays" ? 2 : 1
set multiplot layout 2, n
array colours[6] = ["#808080", "#c02020", "#2040c0", "#208040", "#a06000", "#602080"]
do for [kind = 1:2] {
    do for [k = 1:n] {
        s = word(scenes, k)
        noise = real(word(system(sprintf("cat '%s/%s-noise'", dir, s)), kind))
        set title s.(kind == 1 ? ", by pixel" : ", by block of 4x4")
        set xlabel x eq "rays" ? "million rays" : "user seconds"
        set ylabel k == 1 ? "log-rmse" : ""
        if (kind * k > 1) { unset key } else { set key }
        set yrange [*:*]
        list = ""
        do for [j = 1:nlines] {
            if (there(s, j) > 0) { list = list.sprintf(" %d", j) }
        }
        plot for [i = 1:words(list)] file(s, int(word(list, i))) \
            using column:kind + 2 with linespoints pt 7 ps .6 lw 1.5 \
            lc rgb colours[int(word(list, i))] title name(int(word(list, i))), \
            (noise > 0 ? noise : NaN) with lines dt 3 lc rgb "black" \
            title "noise of the reference"
    }
}
unset multiplot
