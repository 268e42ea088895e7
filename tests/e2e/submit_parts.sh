#!/bin/sh
# submit_parts.sh - instances and meshes through real daemons: the files travel
# with the job, by their content; the scene's folder is gone when it is rendered
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

radscene=$top_builddir/radscene
sock=$work/coord.sock
view="-vp 0 -9 4 -vd 0 9 -3 -vu 0 0 1 -vh 50 -vv 40 -x 96 -y 80 -ab 0"

# make_scene FOLDER RADIUS: a scene of an octree that is not frozen, in an
# octree, and meshes; RADIUS is that of the balls in the former
make_scene()
{
    mkdir "$1" && cd "$1" || exit 99
    cp "$scenes/ball.rtm" .
    printf 'void plastic blue 0 0 5 .2 .2 .7 0 0\n' >leaf.rad
    printf 'blue sphere leaf 0 0 4 0 0 0 %s\n' "$2" >leaf2.rad
    # as oconv without -f writes it: names, count, no tree that counts
    {
        printf '#?RADIANCE\nFORMAT=Radiance_octree\n\n\001\037-1\000-1\000-1\0002\000'
        printf 'leaf.rad\000!cat leaf2.rad\000\000\000\000\000\002\000'
    } >leaf.oct
    cat >twig.rad <<'END'
void instance a 5 leaf.oct -t -.5 0 0 0 0
void instance b 7 leaf.oct -s .6 -t .7 0 0 0 0
void mesh c 7 ball.rtm -s .4 -t 0 .2 1 0 0
END
    "$radscene" freeze --commands twig.rad >twig.oct || exit 99
    cat >scene.rad <<'END'
void light lamp 0 0 3 90 90 90
lamp sphere sun 0 0 4 3 -6 9 .5
void plastic soil 0 0 5 .5 .4 .3 0 0
soil ring ground 0 0 8 0 0 -1.2 0 0 1 0 9
void instance one 5 twig.oct -t -2 0 0 0 0
void instance two 8 twig.oct -mx -rz 40 -t 2 0 .5 0 0
soil instance three 7 twig.oct -s 1.5 -t 0 3 0 0 0
void glass pane 0 0 3 .8 .9 .8
pane mesh ball 5 ball.rtm -t 0 -1.5 0 0 0
END
    cd ..
}

# headers may differ
same_pixels()
{
    for f; do
        LC_ALL=C sed '1,/^$/d' "$f" >"$f.body"
    done
    cmp "$1.body" "$2.body"
}

"$radcoord" --listen= --socket="$sock" --state="$work/state" 2>coord.log &
until_true 20 "$radctl" --coordinator="$sock" status || fail "no coordinator"

# two scenes with the same names and other content
make_scene first .5
make_scene second .3
for scene in first second; do
    # shellcheck disable=SC2086 # options are words
    "$top_builddir/tests/tools/seqpict" $view -o $scene.ref \
        "$scene/scene.rad" || fail "seqpict $scene"
    id=$(cd $scene && "$radsubmit" --coordinator="$sock" --detach --commands $view \
        scene.rad 2>../stderr) || fail "$scene: $(cat stderr)"
    eval id_$scene="$id"
    "$radscene" freeze --commands $scene/twig.rad >$scene.twig || fail "freeze again"
    rm -r $scene
done
cmp -s first.ref second.ref && fail "two scenes look the same"

# only now is there a worker
"$radd" --coordinator="$sock" --name=ws1 --threads=1 --listen=127.0.0.1:0 \
    --cache="$work/cache" 2>radd.log &
for scene in first second; do
    eval id="\$id_$scene"
    until_true 60 "$radctl" --coordinator="$sock" fetch "$id" -o $scene.hdr ||
        fail "$scene is never rendered: $(cat radd.log)"
    same_pixels $scene.hdr $scene.ref || fail "$scene: not one thread's picture"
done

# what is in them is told
make_scene third .4
"$radscene" info --commands third/scene.rad >info || fail "info"
for line in 'file twig.oct instance objects 3 copies 3' \
    'file leaf.oct instance objects 2 copies 2' \
    'file ball.rtm mesh triangles 572 copies 2'; do
    grep -qx "$line" info || fail "info does not say '$line': $(cat info)"
done
printf 'void light l 0 0 3 9 9 9\nl sphere s 0 0 4 0 0 0 1\n' >lamp.rad
"$radscene" freeze lamp.rad >lamp.oct || fail "freeze"
printf 'void instance i 1 lamp.oct 0 0\n' >lamps.rad
expect 0 "1 surface of instances and meshes is of a light source's material" \
    "warning of a lamp" "$radscene" freeze lamps.rad
printf 'void glow l 0 0 4 9 9 9 5\nl instance i 1 twig.oct 0 0\n' >glowing.rad
RAYPATH=third expect 0 \
    "1 surface of instances and meshes is of a light source's material" \
    "warning of what shines as a whole" \
    "$radscene" freeze --commands glowing.rad

# a file that is missing is named with its place
rm third/ball.rtm
expect 66 "twig.oct: mesh 'c': cannot find file 'ball.rtm'" \
    "missing mesh" "$radscene" check --commands third/scene.rad
finish
