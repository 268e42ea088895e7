#!/bin/sh
# submit_header.sh - what a picture's header tells of where it is from
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

mkdir here there
cp "$scenes/room.rad" here/room.rad
cp "$scenes/room.rad" there/room.rad
cp "$scenes/room.vf" v.vf
render="$radsubmit --local --workers=1 --threads=1 -vf v.vf -x 16 -y 12"

header()
{
    sed '/^$/q' "$1" | tr -d '\0'
}

says() # FILE LINE
{
    header "$1" | grep -qx -- "$2" ||
        fail "$1 does not say '$2': $(header "$1")"
}

$render -o a.hdr here/room.rad 2>stderr || fail "$(cat stderr)"
$render -o b.hdr "$PWD/there/room.rad" 2>stderr || fail "$(cat stderr)"
says a.hdr 'SCENE= room.rad'
says a.hdr "SOFTWARE= radd $("$radsubmit" --version | sed 's/.* //')"
header a.hdr | grep -qE '^(CAPDATE|GMT|HOST|JOB)=' &&
    fail "there is a stamp that nobody asked for"
cmp a.hdr b.hdr || fail "the folder of the scene shows in the picture"

# an octree's own header
"$top_builddir/radscene" freeze here/room.rad >room.oct 2>stderr ||
    fail "freeze: $(cat stderr)"
{
    echo '#?RADIANCE'
    echo 'oconv -f cellar.rad'
    sed 1d room.oct
} >told.oct
$render -o c.hdr told.oct 2>stderr || fail "$(cat stderr)"
says c.hdr 'oconv -f cellar.rad'
says c.hdr 'SCENE= told.oct'

# the stamp, also where nobody waits for the picture
day=$(date -u +%Y:%m:%d)
$render --stamp -o d.hdr here/room.rad 2>stderr || fail "$(cat stderr)"
header d.hdr | grep -q "^GMT= $day " || [ "$day" != "$(date -u +%Y:%m:%d)" ] ||
    fail "no day: $(header d.hdr)"
header d.hdr | grep -q '^CAPDATE= [0-9:]* [0-9:]*$' || fail "no CAPDATE"
header d.hdr | grep -q '^HOST= .' || fail "no host"
header d.hdr | grep -qE '^JOB= [0-9a-f]{32}$' || fail "no job"
header d.hdr | grep -vE '^(CAPDATE|GMT|HOST|JOB)=' >d.head
header a.hdr | cmp - d.head || fail "a stamp changes more than its lines"

cluster_start 1 1
id=$("$radsubmit" --coordinator="$sock" --detach --stamp -vf v.vf -x 16 -y 12 \
    here/room.rad) || fail "--detach"
until "$radctl" --coordinator="$sock" fetch "$id" -o e.hdr 2>stderr; do
    [ $? -eq 75 ] || { fail "fetch: $(cat stderr)"; break; }
    sleep .1
done
says e.hdr "JOB= $id"
finish
