"""pairs.py - each program with each pair of its options

    pairs.py BUILD SCENES WORK daemons|clients

A daemon's run takes a value for each of its options; runs are chosen so that
every value of every option meets every value of every other one.  A run either
serves (it is asked, a job is submitted, it ends with status 0 when told to) or
is refused as its table says.  radsubmit and radctl get pairs that a seed draws
(RADD_SEED, RADD_PAIRS of them; all with RADD_SOAK=long); they may refuse a pair
if they say which option they do not like.  What radsubmit writes with a pair it
writes again, to the byte, on a cluster that shares the work out.

What no run may do: crash, call itself defective (status 70), hang, or be told
of by a sanitizer.  An option of --help that no table here has is an error.
"""

import itertools
import os
import random
import re
import signal
import socket
import subprocess
import sys
import time

BUILD, SCENES, WORK = (os.path.abspath(p) for p in sys.argv[1:4])
WHAT = sys.argv[4]
SEED = int(os.environ.get("RADD_SEED", "1"))
ALL = os.environ.get("RADD_SOAK") == "long"
PAIRS = int(os.environ.get("RADD_PAIRS", "60"))
LIMIT_S = 300  # a run that takes longer hangs, however busy the machine is
ROOM = os.path.join(SCENES, "room.rad")
VIEW = "-vtv -vp 2 .15 1.3 -vd 0 1 -.12 -vu 0 0 1 -vh 75 -vv 60".split()
SMALL = VIEW + "-x 16 -y 12 -ps 2 -ab 0".split()
TOLD = re.compile(r"Sanitizer|runtime error|Assertion|core dumped")
faults = []


def fault(what, words, text=""):
    faults.append(what)
    print("FAIL:", what, "\n  ", " ".join(words), "\n  ", text.strip()[-2000:])


def path(name):
    return os.path.join(WORK, name)


def program(name):
    return os.path.join(BUILD, name)


def fresh(name):
    """A name that no run had before."""
    fresh.n += 1
    return path("%s%d" % (name, fresh.n))


fresh.n = 0


def run(words, stdin=subprocess.DEVNULL):
    """Status, stdout and stderr; what no run may do is a fault."""
    try:
        p = subprocess.run(words, stdin=stdin, capture_output=True, cwd=WORK,
                           timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        fault("hangs", words)
        return None, "", ""
    out = p.stdout.decode(errors="replace")
    err = p.stderr.decode(errors="replace")
    if p.returncode < 0 or p.returncode == 70 or p.returncode > 78 or \
            TOLD.search(err):
        fault("status %d" % p.returncode, words, err)
    return p.returncode, out, err


def options_of(name):
    """The long options that --help names."""
    text = run([program(name), "--help"])[1]
    return re.findall(r"^  --([a-z-]+)", text, re.M)


def check_tables(name, *tables):
    known = set().union(*tables) | {"help", "version"}
    for option in options_of(name):
        if option not in known:
            fault("no values to try for", [name, "--" + option])


def cover(values, rng):
    """Runs (dicts) in which each two values of different options meet."""
    names = list(values)
    left = {((a, i), (b, j))
            for a, b in itertools.combinations(names, 2)
            for i in range(len(values[a])) for j in range(len(values[b]))}
    while left:
        best, gain = None, -1
        for _ in range(1 if len(left) < 4 else 20):
            (a, i), (b, j) = rng.choice(sorted(left))
            pick = {n: rng.randrange(len(values[n])) for n in names}
            pick[a], pick[b] = i, j
            got = sum(((x, pick[x]), (y, pick[y])) in left
                      for x, y in itertools.combinations(names, 2))
            if got > gain:
                best, gain = pick, got
        left -= {((x, best[x]), (y, best[y]))
                 for x, y in itertools.combinations(names, 2)}
        yield {n: values[n][best[n]] for n in names}


# --- daemons ---------------------------------------------------------------

def words_of(name, chosen, by_file):
    """The command line of a run: as options, or by a file."""
    rows = [(k, v) for k, v in chosen.items() if v is not None]
    if not by_file:
        return [program(name)] + ["--%s=%s" % r for r in rows]
    conf = fresh("conf")
    with open(conf, "w") as f:
        for k, v in rows:
            f.write("%s = %s\n" % (k.replace("-", "_"), v))
    return [program(name), "--config=" + conf]


class Daemon:
    def __init__(self, words, ports):
        self.words, self.log = words, fresh("log")
        with open(self.log, "w") as f:
            self.p = subprocess.Popen(words, stdin=subprocess.DEVNULL,
                                      stderr=f, cwd=WORK)
        end = time.monotonic() + LIMIT_S
        while self.p.poll() is None and not os.path.exists(ports):
            if time.monotonic() > end:
                fault("never listens", words, self.text())
                break
            time.sleep(.01)
        self.at = open(ports).read().split("\n")[:-1] \
            if os.path.exists(ports) else []

    def text(self):
        return open(self.log, errors="replace").read()

    def refused(self):
        return self.p.poll()

    def address(self, kind):
        return next((a.split(" ", 1)[1] for a in self.at
                     if a.startswith(kind)), None)

    def end(self):
        if self.p.poll() is None:
            self.p.send_signal(signal.SIGTERM)
        try:
            status = self.p.wait(LIMIT_S)
        except subprocess.TimeoutExpired:
            self.p.kill()
            status = "none, it does not end"
        if status != 0 or TOLD.search(self.text()):
            fault("status %s at its end" % status, self.words, self.text())


def expect_refusal(d, want):
    status = d.p.wait(LIMIT_S)
    text = d.text()
    if status not in want or not text or TOLD.search(text):
        fault("status %s, expected %s" % (status, want), d.words, text)


def start(name, c, by_file, refusal):
    """The daemon, if it is to serve and does."""
    d = Daemon(words_of(name, c, by_file), c["ports-file"])
    if refusal:
        expect_refusal(d, refusal)
    elif d.refused() is not None:
        fault("is refused", d.words, d.text())
    else:
        return d
    return None


def visit(address):
    """Somebody who connects and says nothing that makes sense."""
    host, port = address.rsplit(":", 1)
    host = host.strip("[]")
    host = {"::": "::1", "0.0.0.0": "127.0.0.1"}.get(host, host)
    with socket.create_connection((host, int(port)), timeout=60) as s:
        s.sendall(b"GET / HTTP/1.0\r\n\r\n" + bytes(100))


def make_key(name, file):
    out = run([program("radctl"), "key", "add", name, "--keys=" + path("keys")])
    with open(os.open(path(file), os.O_CREAT | os.O_WRONLY, 0o600), "w") as f:
        f.write(out[1])


def make_keys():
    for name, role in (("w1.key", "worker:w1"), ("user.key", "user:ana"),
                       ("admin.key", "admin:root")):
        make_key(role, name)


def client(address, key):
    return ["--coordinator=" + address] + (["--key=" + path(key)] if key else [])


COORD = {
    "listen": ["", "127.0.0.1:0", "localhost:0", "*:0"],
    "socket": ["", "s"],  # "s": a path of its own
    "keys": [None, path("keys")],
    "ports-file": ["file"],
    "state": ["dir"],
    "log-level": ["err", "debug"],
}
# each also with the value that --help names
COORD_MORE = {
    "keep-jobs": ["10", "100000"],
    "keep-days": ["0", "1"],
    "keep-mib": ["0", "1"],
    "keep-caches-mib": ["0", "1"],
    "keep-unfetched-days": ["0", "100"],
    "lease-floor-s": ["1", "1000"],
    "user-jobs": ["1", "10000"],
    "user-frames": ["1", "1000000"],
    "user-unfetched": ["1", "1000"],
    "user-mib": ["1", "1000"],
    "user-uploads": ["2", "10000"],
    "user-upload-mib": ["1", "1000"],
    "user-connections": ["1", "10000"],
    "user-answers": ["1", "100000"],
    "user-unread-mib": ["1", "65536"],
    "upload-s": ["10", "86400"],
    "logins": ["ana=-", "ana=root", "ana=nobody,bo=nobody"],
}


def coord_refusal(c):
    if not c["listen"] and not c["socket"]:
        return (64, 78)
    if c["listen"].startswith("*") and not c["keys"]:
        return (77,)
    return None


def try_coord(chosen, by_file):
    c = dict(chosen)
    c["state"], c["ports-file"] = fresh("state"), fresh("ports")
    if c["socket"]:
        c["socket"] = fresh("sock")
    d = start("radcoord", c, by_file, coord_refusal(chosen))
    if not d:
        return
    ways = []
    if d.address("unix"):
        ways.append(client(d.address("unix"), None))
    if d.address("tcp"):
        visit(d.address("tcp"))
        if c["keys"]:
            port = d.address("tcp").rsplit(":", 1)[1]
            ways.append(client("127.0.0.1:" + port, "admin.key"))
    for way in ways:
        for words in (["status"], ["jobs"], ["workers", "--json"]):
            if run([program("radctl")] + way + words)[0] != 0:
                fault("is not told " + words[0], d.words, d.text())
        status, job, err = run([program("radsubmit")] + way + SMALL +
                               ["--detach", ROOM])
        if status != 0:
            fault("a job is refused", d.words, err)
        elif run([program("radctl")] + way + ["cancel", job.strip()])[0] != 0:
            fault("a job is not cancelled", d.words, d.text())
    d.end()


RADD = {
    "coordinator": ["unix", "tcp"],
    "key": [None, path("w1.key"), path("user.key")],
    "name": [None, "w1", "other"],
    "listen": ["127.0.0.1:0", "*:0", "s"],
    "cache": ["dir"],
    "ports-file": ["file"],
    "hours": ["", "mon-sun"],
    "idle-only": ["no", "yes"],
    "nice": ["0", "19"],
    "sandbox": ["auto", "required"],
    "log-level": ["err", "debug"],
    "threads": ["0", "1", "3"],
}
# AddressSanitizer takes more addresses than any limit leaves
LIMITED = b"__asan_init" not in open(program("radd"), "rb").read()
RADD_MORE = {
    "memory-mib": ["0", "100000"] if LIMITED else ["0"],
    "pixel-s": ["0", "100"],
    "load-s": ["100"],
    "cache-mib": ["0", "1", "100000"],
}


def radd_refusal(c):
    if c["idle-only"] == "yes" and c["nice"] == "0":
        return (64, 78)
    if not c["key"] and (c["coordinator"] == "tcp" or c["listen"] == "*:0"):
        return (77,)
    if c["coordinator"] == "tcp" and c["key"] == path("user.key"):
        return (76, 77, 78)
    if c["coordinator"] == "tcp" and c["name"] == "other":
        return (76, 77, 78)
    return None


def try_radd(chosen, by_file, coord, picture):
    c = dict(chosen)
    c["cache"], c["ports-file"] = fresh("cache"), fresh("ports")
    c["coordinator"] = coord.address(chosen["coordinator"])
    if c["listen"] == "s":
        c["listen"] = fresh("peer")
    d = start("radd", c, by_file, radd_refusal(chosen))
    if not d:
        return
    if d.address("tcp"):
        visit(d.address("tcp"))
    if chosen["idle-only"] == "no":  # somebody uses a machine that tests run on
        out = fresh("picture") + ".hdr"
        status, _, err = run([program("radsubmit")] +
                             client(coord.address("unix"), None) + SMALL +
                             ["-o", out, ROOM])
        if status != 0:
            fault("renders nothing", d.words, err + d.text())
        elif open(out, "rb").read() != picture:
            fault("renders another picture", d.words)
    d.end()


def start_coord():
    ports = fresh("ports")
    return Daemon([program("radcoord"), "--listen=127.0.0.1:0",
                   "--socket=" + path("coord.sock"), "--state=" + path("st"),
                   "--keys=" + path("keys"), "--ports-file=" + ports], ports)


def with_more(table, more):
    return {**table, **{k: [None] + v for k, v in more.items()}}


def try_daemons():
    rng = random.Random(SEED)
    make_keys()
    check_tables("radcoord", COORD, COORD_MORE, {"config"})
    check_tables("radd", RADD, RADD_MORE, {"config"})
    n = 0
    for chosen in cover(with_more(COORD, COORD_MORE), rng):
        try_coord(chosen, n % 2 == 1)
        n += 1
    out = path("alone.hdr")
    run([program("radsubmit")] + SMALL + ["-o", out, ROOM])
    picture = open(out, "rb").read()
    coord = start_coord()
    for chosen in cover(with_more(RADD, RADD_MORE), rng):
        try_radd(chosen, n % 2 == 1, coord, picture)
        n += 1
    coord.end()
    print("%d runs of daemons" % n)


# --- clients ---------------------------------------------------------------

# what each option may be; @OUT and the like are filled in for each run
SUBMIT = {
    "coordinator": ["--coordinator=@SOCK"],
    "key": ["--key=" + path("user.key")],
    "local": ["--local"],
    "commands": ["--commands"],
    "workers": ["--workers=2"],
    "threads": ["--threads=1"],
    "wait": ["--wait=30"],
    "format": ["--format=png", "--format=hdr", "--format=auto"],
    "tone": ["--tone=photographic", "--tone=linear", "--tone=human"],
    "exposure": ["--exposure=auto", "--exposure=each,+1", "--exposure=.5"],
    "false-colour": ["--false-colour", "--false-colour=100,contour=lines"],
    "bits": ["--bits=8", "--bits=16"],
    "quality": ["--quality=draft"],
    "oversample": ["--oversample=2", "--oversample=3"],
    "clamp": ["--clamp=4"],
    "preview": ["--preview=@OUT.png"],
    "stats": ["--stats=@OUT.json"],
    "progress": ["--progress=always", "--progress=never"],
    "dry-run": ["--dry-run"],
    "detach": ["--detach"],
    "name": ["--name=a name"],
    "priority": ["--priority=-3"],
    "memory-mib": ["--memory-mib=%d" % (100000 if LIMITED else 0)],
    "partition": ["--partition=" + p
                  for p in ("auto", "static", "scanbar", "window")],
    "windows": ["--windows=3"],
    "order": ["--order=random", "--order=cost"],
    "estimate": ["--estimate=uniform", "--estimate=3a", "--estimate=3b",
                 "--estimate=" + path("costs.json")],
    "stamp": ["--stamp"],
    "no-balance": ["--partition=static --no-balance"],
    "ambient": ["--ambient=passes", "--ambient=live"],
    "error": ["--error=50"],
    "time": ["--time=1"],
    "reuse": ["--reuse=last"],
    "launch": ["--launch=env"],
    "address": ["--address=127.0.0.1"],
    "no-share": ["--no-share"],
    "same-bits": ["--same-bits"],
    "fresh-frames": ["--fresh-frames"],
    "views": ["--views=" + path("walk.vf")],
    "points": ["--points=" + path("grid.txt")],
    "job": ["--job=" + "5" * 32],
    "seed": ["--seed=7"],
    "surroundings": ["--surroundings=1", "--surroundings=16"],
    "shown": ["--shown 0 0 0 4", "--surroundings=16 --shown 9 9 1 2"],
    "samples": ["--samples=3"],
    "bands": ["-cs 6", "-cs 6 -co+", "-cs 6 --plane 1", "-cs 6 -cw 500 600"],
    "channels": ["-pXYZ", "-pc .7 .3 .2 .7 .1 .1 .3 .3"],
    "irradiance": ["-i+"],
    "motion": ["-pm .5"],
    "warnings": ["-w-"],
    "view file": ["-vf " + path("walk.vf")],
    "of points": ["-I -h- -ov -faf", "-ld+ -oopNL"],
    "output": ["-o @OUT.hdr", "-o @OUT.png", "-o @OUT%03d.hdr", "-o -",
               "-o @OUT.hsr"],
    "distances": ["-z @OUT.z"],
    "records": ["-af @OUT.amb"],
    "animation": ["-S 1"],
    "bounces": ["-ab 1 -ad 16 -aa .5"],
    "no cache": ["-ab 1 -aa 0 -ad 4"],
    "painting": ["-dv+ -pd .1 -pj .5"],
    "depth": ["-lr -4 -lw .01"],
    "report": ["-t 1 -e @OUT.err"],
    "density": ["-ps 8 -pt 0", "-ps 1"],
    "size": ["-x 1 -y 1", "-x 40 -y 3"],
    "view": ["--view=X"],
    "projection": ["-vth", "-vtl -vh 4 -vv 3"],
    "no-clobber": ["--no-clobber"],
    "rpict-status": ["--rpict-status"],
    "rpict-path": ["--rpict-path"],
    "file": ["@" + path("options")],
    "defaults": ["-defaults"],
}

CTL = {
    "command": ["status", "workers", "jobs", "limits", "job @JOB", "cancel @JOB",
                "pause @JOB", "resume @JOB", "fetch @JOB", "drain nobody",
                "undrain nobody", "delete @JOB", "forget nobody",
                "priority @JOB -1", "key add user:bo", "key retire user:bo",
                "key list", "check @STATE", "job @NONE", "fetch @NONE", "top",
                "enroll ws9", "priority @JOB 1000", "key add bo", ""],
    "coordinator": ["--coordinator=@SOCK", "--coordinator=@TCP"],
    "key": ["--key=" + path("user.key"), "--key=" + path("admin.key")],
    "json": ["--json"],
    "keys": ["--keys=" + path("other.keys")],
    "expires": ["--expires=2127-01-01"],
    "output": ["-o @OUT.hdr", "-o @OUT.png", "-o -"],
    "folder": ["--output=@OUT"],
    "plane": ["--plane"],
    "frame": ["--frame=0", "--frame=5"],
    "tone": ["--tone=linear", "--tone=human"],
    "exposure": ["--exposure=-1", "--exposure=first,2"],
    "false-colour": ["--false-colour", "--false-colour=50,log=2"],
    "bits": ["--bits=8", "--bits=16"],
    "user": ["--user=ana"],
    "state": ["--state=done", "--state=ready"],
    "limit": ["--limit=1"],
    "all": ["--all"],
    "word": ["further"],
}


def told(words, err):
    """Does the message name an option, or the file that it names?"""
    if any(w[w.index(WORK):] in err for w in words[1:] if WORK in w):
        return True
    names = [re.match(r"-+([A-Za-z][A-Za-z-]*)", w) for w in words[1:]]
    return any(n and re.search(r"(-|'|\b)%s\b" % re.escape(n[1]), err)
               for n in names if n and (len(n[1]) > 1 or "-" + n[1] in err))


def draw(table, rng):
    choices = [(o, v) for o in table for v in table[o]]
    two = [p for p in itertools.combinations(choices, 2) if p[0][0] != p[1][0]]
    return two if ALL else rng.sample(two, min(PAIRS, len(two)))


def filled(text, names):
    for k, v in names.items():
        text = text.replace(k, v)
    return text


def split(option):
    return option.split(" ") if not option.startswith("--name") else [option]


# options that say where a job runs, and those with which nothing is written, or
# something that follows from the time or from what ran before
ELSEWHERE = {"coordinator", "local", "launch", "address", "key", "workers",
             "threads", "detach", "dry-run", "job", "defaults", "rpict-path",
             "time", "reuse"}
# with ambient values, what a ray finds is whatever was made until then
LIVE = {"--ambient=live", "--no-share", "--fresh-frames"}
STAMP = re.compile(rb"^(CAPDATE|GMT|HOST|JOB)=.*\n", re.M)


def follows_from_options(pair):
    chosen = {o for o, _ in pair}
    live = LIVE & {v for _, v in pair} and chosen & {"bounces", "quality"}
    return not chosen & ELSEWHERE and not live


def written(out, stdout):
    """All that a run has written, but for times."""
    start = os.path.basename(out)
    files = {"": stdout}
    for name in os.listdir(WORK):
        if name.startswith(start) and not name.endswith((".json", ".err")):
            with open(path(name), "rb") as f:
                files[name[len(start):]] = STAMP.sub(b"", f.read())
    return files


def check_shared(words, names, stdin, alone):
    """The same words on a cluster, whose workers share the job."""
    out = fresh("out") + "_"
    words = [w.replace(names["@OUT"], out) for w in words if w != "--local"]
    words.insert(1, "--coordinator=" + names["@SOCK"])
    status, stdout, err = run(words, stdin)
    if status != 0:
        fault("status %s on a cluster" % status, words, err)
    elif written(out, stdout) != alone:
        fault("other bytes on a cluster than alone", words, err)


def try_submit(pair, names):
    words = [program("radsubmit")]
    names = {**names, "@OUT": fresh("out") + "_"}
    options = [w for _, v in pair for w in split(filled(v, names))]
    chosen = {o for o, _ in pair}
    # -o is a picture's, or an animation's frames'
    if "output" not in chosen and "defaults" not in chosen:
        options += ["-o", names["@OUT"] +
                    ("%d.hdr" if chosen & {"views", "animation"} else ".hdr")]
    if not chosen & {"coordinator", "local", "detach", "key", "launch"}:
        options += ["--local"]
    if chosen & {"detach", "key"} and not chosen & {"coordinator", "local"}:
        options += ["--coordinator=" + names["@SOCK"]]
    words += SMALL + options + ([] if "defaults" in chosen else [ROOM])
    with open(path("walk.vf")) as views:
        stdin = views if "animation" in chosen else subprocess.DEVNULL
        status, stdout, err = run(words, stdin)
        if status == 0 and follows_from_options(pair):
            views.seek(0)
            check_shared(words, names, stdin, written(names["@OUT"], stdout))
    if status == 76 or (status and not told(words, err)):
        fault("status %d, and no option is named" % status, words, err)
    if status == 0 and TOLD.search(err):
        fault("told of by a sanitizer", words, err)
    return status == 0


def try_ctl(pair, names):
    names = {**names, "@OUT": fresh("out")}
    words = [program("radctl")]
    chosen = {o for o, _ in pair}
    for option, value in sorted(pair, key=lambda p: p[0] != "command"):
        words += [w for w in filled(value, names).split(" ") if w]
    if not chosen & {"coordinator", "keys"}:
        words += ["--coordinator=" + names["@SOCK"]]
    status, _, err = run(words)
    if status == 76 or (status and not err.strip()):
        fault("status %d without a word" % status, words, err)
    return status == 0


def worker_of_clients(name):
    ports = fresh("ports")
    return Daemon([program("radd"), "--coordinator=" + path("coord.sock"),
                   "--name=" + name, "--threads=1", "--cache=" + fresh("cache"),
                   "--nice=0", "--listen=127.0.0.1:0",
                   "--ports-file=" + ports], ports)


def try_clients():
    rng = random.Random(SEED)
    make_keys()
    check_tables("radsubmit", SUBMIT)
    check_tables("radctl", CTL)
    with open(path("walk.vf"), "w") as f:
        f.write("rvu -vtv -vp 2 .15 1.3 -vd 0 1 -.12 -vu 0 0 1 -vh 75 -vv 60\n")
        f.write("rvu -vtv -vp 2 .35 1.3 -vd 0 1 -.12 -vu 0 0 1 -vh 75 -vv 60\n")
    with open(path("grid.txt"), "w") as f:
        f.write("2 1 1 0 0 1\n2 2 1 0 0 1\n")
    with open(path("options"), "w") as f:
        f.write("-ab 0 -ps 2\n")
    run([program("radsubmit"), "--stats=" + path("costs.json"), "-o",
         path("costs.hdr")] + SMALL + [ROOM])
    coord = start_coord()
    workers = [worker_of_clients(w) for w in ("w1", "w2")]
    job = run([program("radsubmit"), "--coordinator=" + path("coord.sock"),
               "--detach"] + SMALL + [ROOM])[1].strip()
    names = {"@SOCK": path("coord.sock"), "@TCP": coord.address("tcp"),
             "@JOB": job, "@NONE": "0" * 32, "@STATE": path("st")}
    done = [try_submit(p, names) for p in draw(SUBMIT, rng)] + \
           [try_ctl(p, names) for p in draw(CTL, rng)]
    for worker in workers:
        worker.end()
    coord.end()
    print("%d pairs of clients' options, %d did what they say" %
          (len(done), sum(done)))
    if sum(done) * 4 < len(done):
        fault("most pairs are refused", ["radsubmit", "radctl"])


{"daemons": try_daemons, "clients": try_clients}[WHAT]()
sys.exit(1 if faults else 0)
