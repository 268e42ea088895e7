"""click.py URL ID FOLDER RADCTL...: through radweb's pages as a browser shows
them, compared with what `radctl --json` says; pictures of them go to FOLDER"""
import json
import struct
import subprocess
import sys
import time
import urllib.request

from browser import Browser

url, job, folder = sys.argv[1:4]
words = sys.argv[4:]

CELLS = """Array.from(document.querySelectorAll("#%s tbody tr")).map(
    r => Array.from(r.cells).map(c => c.textContent.trim()))"""
LIVE = "document.getElementById('live').className === 'on'"
SHOWN = "document.querySelector('canvas.view') && " \
        "!document.querySelector('canvas.view').hidden"


def radctl(*what):
    return json.loads(subprocess.run(words + list(what), check=True,
                                     capture_output=True).stdout)


def compare_lists(b):
    rows = {r[0]: r for r in b.run(CELLS % "jobs")}
    for j in radctl("jobs"):
        r = rows[j["job"][:8]]
        assert r[1] == j["name"], r
        assert r[2] == j["state"], r
        assert r[3] == "%d %%" % (100 * j["done"]), r
        assert r[6:9] == [j["owner"], str(j["priority"]), str(j["workers"])], r
    rows = {r[0]: r for r in b.run(CELLS % "workers")}
    for w in radctl("workers"):
        r = rows[w["name"]]
        assert [r[1]] + r[3:5] == [w["state"], str(w["threads"]),
                                   str(w["units"])], rows
        assert abs(float(r[2]) - w["load"]) <= 10, rows


def compare_lists_in_time(b):
    """The page lags behind by what it takes to hear of a change."""
    until = time.monotonic() + 200
    while True:
        try:
            return compare_lists(b)
        except (AssertionError, KeyError):
            if time.monotonic() > until:
                raise
            time.sleep(.2)


def fits(b, what):
    wide = b.run("document.documentElement.scrollWidth - innerWidth")
    assert wide <= 0, "%s is %d wider than its window" % (what, wide)


def luminance_at(x, y):
    data = urllib.request.urlopen(
        "%s/jobs/%s/picture.rgbe" % (url, job)).read()
    width = struct.unpack(">I", data[4:8])[0]
    at = 16 + 4 * (y * width + x)
    r, g, bl, e = data[at:at + 4]
    return 179 * 2.0 ** (e - 136) * (.265074 * (r + .5) + .670115 * (g + .5) +
                                     .064811 * (bl + .5)) if e else 0


def compare_probe(b):
    """What is said of a pixel is the picture's; returns where it is."""
    said = b.until("document.querySelector('#probe b') && "
                   "document.getElementById('probe').textContent")
    x, y = int(said.split()[1]), int(said.split()[3].rstrip(":"))
    told = float(said.split(": ")[1].split()[0])
    assert abs(told / luminance_at(x, y) - 1) < .01, (said, luminance_at(x, y))
    return x, y


def compare_pixels(b):
    """By the pointer, and by the keys of those who have none."""
    b.point("canvas.view")
    x, y = compare_probe(b)
    b.run("document.querySelector('canvas.view').focus()")
    for key in ("ArrowRight", "ArrowUp"):
        b.press(key)
    assert compare_probe(b) == (x + 1, y - 1)


def draw_otherwise(b):
    sum_of = """(() => {
        const c = document.querySelector("canvas.view");
        const d = c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
        return d.reduce((a, v) => a + v, 0);
    })()"""
    change = """(() => {
        const e = document.getElementById("%s");
        e.value = "%s";
        e.dispatchEvent(new Event("%s"));
    })()"""
    plain = b.run(sum_of)
    b.run(change % ("exposure", "2", "input"))
    assert b.run(sum_of) > plain, "two stops more are not brighter"
    b.run(change % ("exposure", "0", "input"))
    assert b.run(sum_of) == plain
    b.run(change % ("mode", "log", "change"))
    assert b.run(sum_of) != plain
    assert "cd/m" in b.run(
        "document.querySelector('.tools span:last-of-type').textContent")
    b.run(change % ("mode", "tone", "change"))


def look_at(b, width, dark):
    name = "%s/%%s-%d-%s.png" % (folder, width, "dark" if dark else "light")
    b.size(width, 900, dark)
    b.open(url + "/")
    b.until(LIVE)
    fits(b, "the cluster's page")
    b.shoot(name % "cluster")
    b.click("a[href='jobs/%s']" % job)
    b.until("location.pathname === '/jobs/%s'" % job)
    b.until("document.readyState === 'complete' && " + LIVE)
    b.until(SHOWN)
    fits(b, "the job's page")
    b.shoot(name % "job")
    colour = b.run("getComputedStyle(document.body).backgroundColor")
    assert (int(colour.split("(")[1].split(",")[0]) < 100) == dark, colour


def without_script(b):
    b.say("Emulation.setScriptExecutionDisabled", value=True)
    b.say("Page.navigate", url="%s/jobs/%s" % (url, job))
    b.say("Page.navigate", url="%s/jobs/%s" % (url, job))
    b.until("document.querySelector('#shown') && "
            "document.querySelector('#shown').naturalWidth > 0")
    assert not b.run("document.querySelector('canvas')")
    b.say("Emulation.setScriptExecutionDisabled", value=False)


def streams():
    said = urllib.request.urlopen(url + "/metrics").read().decode()
    return int(said.split("\nradweb_streams ")[1].split()[0])


def has_streams(n):
    until = time.monotonic() + 200
    while streams() != n:
        assert time.monotonic() < until, (n, streams())
        time.sleep(.2)


HIDE = """Object.defineProperty(document, "hidden",
                                { value: %s, configurable: true });
    document.dispatchEvent(new Event("visibilitychange"))"""


def not_seen(b):
    """A page that is not seen keeps no connection."""
    for hidden, n in (("false", 1), ("true", 0), ("false", 1)):
        b.run(HIDE % hidden)
        has_streams(n)


def hears_late(b):
    """A page that was not seen while its job was deleted says so in the end, and
    keeps no connection, for nothing more comes."""
    b.open("%s/jobs/%s" % (url, job))
    b.until(LIVE)
    b.run(HIDE % "true")
    has_streams(0)
    subprocess.run(words + ["delete", job], check=True, capture_output=True)
    b.run(HIDE % "false")
    b.until("document.querySelector('#trouble').textContent.includes("
            "'This job is gone')")
    assert not b.run(LIVE)
    has_streams(0)


def main():
    b = Browser(folder + "/browser")
    try:
        b.size(1280, 900)
        b.open(url + "/")
        b.until(LIVE)
        compare_lists_in_time(b)
        for width in (1280, 390):
            for dark in (False, True):
                look_at(b, width, dark)
        b.size(1280, 900)
        b.open("%s/jobs/%s" % (url, job))
        b.until(SHOWN)
        compare_pixels(b)
        draw_otherwise(b)
        assert b.run("document.querySelector('h1').textContent") == \
            radctl("job", job)["name"]
        # a bookmark with the token in it
        b.open("%s/jobs/%s" % (url.replace("://", "://me:word@"), job))
        b.until(SHOWN)
        without_script(b)
        # a job that comes stands there without a click, and the focus stays
        b.open(url + "/")
        b.until(LIVE)
        b.run("document.querySelector(\"a[href='jobs/%s']\").focus()" % job)
        n = len(b.run(CELLS % "jobs"))
        print("look", flush=True)
        sys.stdin.readline()
        b.until("document.querySelectorAll('#jobs tbody tr').length > %d" % n)
        assert b.run("document.activeElement.href").endswith(job)
        not_seen(b)
        hears_late(b)
        said = b.complaints()
        assert not said, said
    finally:
        b.close()


main()
