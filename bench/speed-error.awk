# speed-error.awk - table of speed against error (speed-error.sh)
#
# Lines of scene, program, threads (0: rpict), setting, run, user seconds, wall
# seconds, rays, records, mean ratio, error by pixel and by block; for each
# scene one of its reference: width, height, those of what is rendered, and its
# own noise by pixel and by block.  Figures are medians of the runs.
# Variable plots: folder for what is to be drawn.

function median(list,   v, n, i, j, t) {
    n = split(list, v, " ")
    for (i = 2; i <= n; i++)
        for (j = i; j > 1 && v[j] + 0 < v[j - 1] + 0; j--) {
            t = v[j]; v[j] = v[j - 1]; v[j - 1] = t
        }
    return n % 2 ? v[(n + 1) / 2] : (v[n / 2] + v[n / 2 + 1]) / 2
}

# The figure f of scene s, line l (program and threads) and setting r.
function of(s, l, r, f) { return median(all[s, l, r, f]) }

# The settings of a line, by time; their number.
function by_time(s, l, order,   n, i, j, t) {
    for (i = 1; i <= nrungs; i++)
        if ((s, l, rung[i]) in seen)
            order[++n] = rung[i]
    for (i = 2; i <= n; i++)
        for (j = i; j > 1 &&
             of(s, l, order[j], "user") < of(s, l, order[j - 1], "user"); j--) {
            t = order[j]; order[j] = order[j - 1]; order[j - 1] = t
        }
    return n
}

# What f (user, rays) a line needs for an error e by kind (pixel, block): where
# the line, straight between points in logarithms, first comes down to it.
# Sets bound to "<" where its coarsest point is better already; 0: it never
# comes there.
function needed(s, l, f, kind, e,   order, n, i, e0, e1, t0, t1) {
    bound = " "
    n = by_time(s, l, order)
    for (i = 1; i <= n; i++) {
        e1 = of(s, l, order[i], kind)
        t1 = of(s, l, order[i], f)
        if (e1 <= e) {
            if (i == 1) {
                bound = "<"
                return t1
            }
            return exp(log(t0) + log(t1 / t0) * log(e0 / e) / log(e0 / e1))
        }
        e0 = e1
        t0 = t1
    }
    return 0
}

function name(l) {
    return l == "rpict 0" ? "rpict" : l == "radd 1" ? "radsubmit" : \
        sprintf("radsubmit, %d threads", substr(l, 6))
}

# How much less a line needs than rpict at rpict's error.
function gain(s, l, r, f, kind,   t) {
    t = needed(s, l, f, kind, of(s, "rpict 0", r, kind))
    if (!t) {
        never[l, f, kind]++
        return "       -"
    }
    t = of(s, "rpict 0", r, f) / t
    gains[l, f, kind] = gains[l, f, kind] " " t
    return sprintf("%s%7.2f", bound == "<" ? ">" : " ", t)
}

function scene_table(s,   i, j, l, r, file) {
    printf "\n%s, %s, noise of the reference %s by pixel, %s by block\n",
        s, size[s], noise_pixel[s], noise_block[s]
    printf "%-18s %-21s %8s %8s %8s %8s %7s %7s %7s\n", "setting", "",
        "user s", "wall s", "10^6 ray", "records", "mean", "pixel", "block"
    for (i = 1; i <= nrungs; i++)
        for (j = 1; j <= nlines; j++) {
            l = line[j]
            r = rung[i]
            if (!((s, l, r) in seen))
                continue
            printf "%-18s %-21s %8.2f %8.2f %8.2f %8s %7.4f %7.4f %7.4f\n", r,
                name(l), of(s, l, r, "user"), of(s, l, r, "wall"),
                of(s, l, r, "rays") / 1e6, l == "rpict 0" ? "-" : \
                of(s, l, r, "records"), of(s, l, r, "mean"),
                of(s, l, r, "pixel"), of(s, l, r, "block")
            file = plots "/" s "-" l ".dat"
            print of(s, l, r, l ~ /^(rpict 0|radd 1)$/ ? "user" : "wall"),
                of(s, l, r, "rays") / 1e6, of(s, l, r, "pixel"),
                of(s, l, r, "block") > file
        }
    print s >(plots "/scenes")
    print noise_pixel[s], noise_block[s] >(plots "/" s "-noise")
    if (!has_rpict[s])
        return
    for (j = 1; j <= nlines; j++) {
        l = line[j]
        if (l != "radd 1")
            continue
        printf "at rpict's error, times less: %12s %17s\n", "user seconds",
            "rays"
        printf "%-27s %8s %8s %8s %8s\n", "", "pixel", "block", "pixel",
            "block"
        for (i = 1; i <= nrungs; i++) {
            r = rung[i]
            if ((s, "rpict 0", r) in seen)
                printf "%-27s %s %s %s %s\n", r, gain(s, l, r, "user", "pixel"),
                    gain(s, l, r, "user", "block"),
                    gain(s, l, r, "rays", "pixel"),
                    gain(s, l, r, "rays", "block")
        }
    }
}

function least_and_mean(list, missed,   v, n, i, sum, least) {
    n = split(list, v, " ")
    if (!n)
        return sprintf("never reached, of %d", missed)
    for (i = 1; i <= n; i++) {
        sum += log(v[i])
        if (i == 1 || v[i] < least)
            least = v[i] + 0
    }
    return sprintf("%.2f at least, %.2f on average of %d%s", least,
                   exp(sum / n), n, \
                   missed ? ", not reached at " missed " more" : "")
}

/^#/ { print; next }
$2 == "reference" {
    scene[++nscenes] = $1
    size[$1] = $5 "x" $6 " against " $3 "x" $4
    noise_pixel[$1] = $7
    noise_block[$1] = $8
    next
}
NF != 12 { next }
{
    l = $2 " " $3
    if (!(l in known)) {
        known[l] = 1
        line[++nlines] = l
    }
    if (!($4 in known_rung)) {
        known_rung[$4] = 1
        rung[++nrungs] = $4
    }
    seen[$1, l, $4] = 1
    if ($2 == "rpict")
        has_rpict[$1] = 1
    all[$1, l, $4, "user"] = all[$1, l, $4, "user"] " " ($6 > 0 ? $6 : .001)
    all[$1, l, $4, "wall"] = all[$1, l, $4, "wall"] " " $7
    all[$1, l, $4, "rays"] = all[$1, l, $4, "rays"] " " $8
    all[$1, l, $4, "records"] = all[$1, l, $4, "records"] " " $9
    all[$1, l, $4, "mean"] = all[$1, l, $4, "mean"] " " $10
    all[$1, l, $4, "pixel"] = all[$1, l, $4, "pixel"] " " $11
    all[$1, l, $4, "block"] = all[$1, l, $4, "block"] " " $12
}
END {
    print "setting: -aa/-ar/-ad/-as; mean: mean ratio; pixel, block: log_rmse"
    for (k = 1; k <= nscenes; k++)
        scene_table(scene[k])
    if ("rpict 0" in known && "radd 1" in known) {
        print "\nAll scenes, user seconds less at rpict's error:"
        print "by pixel " least_and_mean(gains["radd 1", "user", "pixel"],
                                         never["radd 1", "user", "pixel"])
        print "by block " least_and_mean(gains["radd 1", "user", "block"],
                                         never["radd 1", "user", "block"])
    }
    for (j = 1; j <= nlines; j++)
        print line[j] "\t" name(line[j]) (line[j] ~ /^(rpict 0|radd 1)$/ ? \
            "" : " (wall)") >(plots "/lines")
}
