"""ask.py PART URL ... - what radweb answers: the parts of tests/e2e/radweb.sh"""
import base64
import html.parser
import http.client
import json
import multiprocessing
import os
import re
import resource
import select
import socket
import ssl
import struct
import subprocess
import sys
import time
import urllib.parse

part, url = sys.argv[1:3]
rest = sys.argv[3:]
where = urllib.parse.urlparse(url)
place = (where.hostname, where.port)


PATIENCE_S = 200  # of a machine that is busy with other things


def get(path, headers=None, method="GET", body=None):
    c = http.client.HTTPConnection(*place, timeout=PATIENCE_S)
    c.request(method, path, body, headers or {})
    r = c.getresponse()
    body = r.read()
    c.close()
    return r, body


def text(path):
    r, body = get(path)
    assert r.status == 200, (path, r.status, body[:300])
    return body.decode()


def until(fn):
    end = time.time() + PATIENCE_S
    while not fn():
        assert time.time() < end, "not in time: " + part
        time.sleep(.1)


class Page(html.parser.HTMLParser):
    """The elements of a page, and its text by section."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.text, self.section = [], {}, ""
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag == "section":
            self.section = dict(attributes)["id"]

    def handle_data(self, data):
        self.text[self.section] = self.text.get(self.section, "") + data


def no_jobs():
    until(lambda: json.loads(text("/api/v1/status.json"))["up"])
    page = text("/")
    assert "No jobs yet" in page and "No worker has come yet" in page
    assert json.loads(text("/api/v1/jobs.json"))["open"] == []


def radctl(word):
    return json.loads(subprocess.run(rest + [word], check=True,
                                     capture_output=True).stdout)


def by_id(row):
    return row["job"]


def same_as_radctl():
    """All members of all rows, at one moment of the last seconds."""
    def same_jobs():
        ours = json.loads(text("/api/v1/jobs.json"))
        return sorted(ours["open"] + ours["over"], key=by_id) == \
            sorted(radctl("jobs"), key=by_id)

    def same_workers():
        ours = json.loads(text("/api/v1/workers.json"))["workers"]
        theirs = radctl("workers")
        for row in ours + theirs:
            del row["since_s"]
        return ours == theirs

    until(same_jobs)
    until(same_workers)
    page = Page(text("/"))
    for j in radctl("jobs"):
        assert j["job"][:8] in page.text["jobs"]
        assert j["name"] in page.text["jobs"], (j["name"], page.text["jobs"])


def names_stay_text():
    for path in ("/", "/jobs/" + rest[0]):
        page = Page(text(path))
        assert "<script>alert(1)</script>" in \
            page.text["jobs" if path == "/" else "job"]
        scripts = [a for t, a in page.tags if t == "script"]
        root = "./" if path == "/" else "./../"
        assert scripts == [{"src": root + "page.js", "defer": None}], scripts
        for tag, attributes in page.tags:
            assert not any(k.startswith("on") or k == "style"
                           for k in attributes), (tag, attributes)
            # below whatever path a proxy has radweb, and nowhere else
            for k in ("src", "href", "data-events", "data-raw"):
                assert re.fullmatch(r"[\w.][\w./?=&-]*", attributes.get(k, ".")), \
                    attributes


def heard():
    """What those need who hear a page, or go through it by keys."""
    needed = {"html": "lang", "th": "scope", "table": "aria-label",
              "img": "alt", "progress": "aria-hidden"}
    for path in ("/", "/jobs/" + rest[0]):
        tags = Page(text(path)).tags
        names = [t for t, _ in tags]
        assert names.count("h1") == 1 and "main" in names, names
        for tag, a in tags:
            assert tag not in needed or a.get(needed[tag]), (tag, a)
            if a.get("class") == "scroll":
                assert "tabindex" in a and "aria-label" in a, a
            if a.get("id") == "live":
                assert a["role"] == "status", a
        assert ("th", {"scope": "row", "class": "name"}) in tags


def pixels(data):
    """Width, height and RGBE of a picture as radd writes it."""
    head, body = data.split(b"\n\n", 1)
    line, body = body.split(b"\n", 1)
    _, height, _, width = line.split()
    width, height = int(width), int(height)
    out, at = bytearray(), 0
    for _ in range(height):
        assert body[at:at + 4] == bytes((2, 2, width >> 8, width & 255))
        at += 4
        row = []
        for _ in range(4):
            channel = bytearray()
            while len(channel) < width:
                n = body[at]
                if n > 128:
                    channel += body[at + 1:at + 2] * (n - 128)
                    at += 2
                else:
                    channel += body[at + 1:at + 1 + n]
                    at += 1 + n
            row.append(channel)
        for p in zip(*row):
            out += bytes(p)
    return width, height, bytes(out)


def picture_is_the_job_s():
    width, height, rgbe = pixels(open(rest[1], "rb").read())

    def same():
        r, body = get("/jobs/%s/picture.rgbe" % rest[0])
        return r.status == 200 and body[:4] == b"RWP1" and \
            struct.unpack(">III", body[4:16]) == (width, height, 1) and \
            body[16:] == rgbe

    until(same)
    r, body = get("/jobs/%s/picture.png" % rest[0])
    assert body[:8] == b"\x89PNG\r\n\x1a\n"
    assert struct.unpack(">II", body[16:24]) == (width, height)
    job = json.loads(text("/api/v1/jobs/%s.json" % rest[0]))
    assert job["api"] == 1 and job["picture"]["width"] == width
    assert job["statistics"]["totals"]["rays"] >= job["job"]["rays"] > 0
    page = text("/jobs/" + rest[0])
    assert "<rect" in page and "cd/m" not in page


def metrics():
    said = text("/metrics")
    assert said.endswith("# EOF\n")
    types, values = {}, {}
    for line in said.splitlines():
        m = re.fullmatch(r"# TYPE (\w+) (gauge|counter)", line)
        if m:
            assert m[1] not in types
            types[m[1]] = m[2]
            continue
        if line.startswith("#"):
            assert re.fullmatch(r"# (HELP \w+ .+|EOF)", line), line
            continue
        m = re.fullmatch(r'(\w+)(\{\w+="[^"]*"\})? (-?[0-9.e+-]+)', line)
        assert m, line
        name = m[1]
        if name not in types:
            name = name[:-len("_total")]
            assert types[name] == "counter" and m[1].endswith("_total"), line
        values[m[1] + (m[2] or "")] = float(m[3])
    assert values["radd_up"] == 1
    assert values["radd_jobs_ended_total{state=\"done\"}"] >= 1
    assert values["radd_rays_total"] > 0
    assert values["radd_threads"] == 2


def headers():
    for path in ("/", "/jobs/" + rest[0], "/metrics", "/nothing", "/page.js"):
        r, _ = get(path)
        csp = r.getheader("Content-Security-Policy")
        assert "default-src 'none'" in csp and "unsafe" not in csp, csp
        assert r.getheader("X-Content-Type-Options") == "nosniff"
    assert get("/nothing")[0].status == 404
    assert get("/jobs/" + 32 * "0")[0].status == 404
    assert get("/jobs/%s?frame=7" % rest[0])[0].status == 404
    assert get("/jobs/../../etc/passwd")[0].status == 404
    assert len(get("/" * 15000)[1]) < 2000
    assert get("/", method="POST")[0].status == 405
    assert get("/", method="POST", body=b"a=b")[0].status == 405
    r, body = get("/", method="HEAD")
    assert r.status == 200 and body == b""


def not_this_machine():
    assert get("/", {"Host": "evil.example"})[0].status == 421
    assert get("/", {"Host": "127.0.0.1.evil.example"})[0].status == 421
    assert get("/", {"Host": "localhost:7480"})[0].status == 200


def command():
    # of the job whose scene has a name that a shell could take amiss
    for job in json.loads(text("/api/v1/jobs.json"))["over"]:
        get("/jobs/%s/picture.png" % job["job"])
        page = Page(text("/jobs/" + job["job"]))
        words = page.text["command"].replace("Command line", "", 1).strip()
        if "gone" in words:
            assert words.startswith("radsubmit -v"), words
            out = subprocess.run(["sh", "-c", "radsubmit() { printf '%s\\n' "
                                  "\"$@\"; }; " + words],
                                 capture_output=True, text=True)
            assert "-o" in out.stdout.split("\n"), out
            assert not os.path.exists("gone.rad"), words
            print(words)
            return
    raise AssertionError("no such job")


def dial():
    return socket.create_connection(place, timeout=PATIENCE_S)


def alive():
    return json.loads(text("/api/v1/status.json"))["up"]


def garbage():
    junk = [b"\0" * 5000, os.urandom(20000), b"GET /\r\n\r\n",
            b"GET / HTTP/9.9\r\n\r\n", b"GET " + b"/" * 40000 + b" HTTP/1.1\r\n",
            b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 20000 + b"\r\n",
            b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: -5\r\n\r\n",
            b"GET / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked"
            b"\r\n\r\nffffffffffffffffffff\r\n",
            b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999"
            b"\r\n\r\n" + b"x" * 100000,
            b"GET /jobs/%00%ff%2e%2e/events HTTP/1.1\r\nHost: localhost\r\n\r\n",
            b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + os.urandom(500)]
    for j in junk:
        s = dial()
        try:
            s.sendall(j)
            s.settimeout(.3)
            answer = s.recv(100)
            assert answer == b"" or answer.startswith(b"HTTP/1.") or \
                answer[:1] == b"\x15", answer
        except (OSError, TimeoutError):
            pass
        s.close()
        assert alive()


def slow():
    """A request that does not end is ended, however steadily it comes."""
    s = dial()
    since = time.time()
    s.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n")
    s.settimeout(.2)
    while True:
        assert time.time() - since < PATIENCE_S
        try:
            s.sendall(b"X-Slow: 1\r\n")
            if s.recv(1000) == b"":
                break
        except TimeoutError:
            time.sleep(.3)
        except OSError:
            break
    assert time.time() - since > 8, time.time() - since


def rss_kb(pid):
    for line in open("/proc/%s/status" % pid):
        if line.startswith("VmRSS"):
            return int(line.split()[1])


def coordinator_ms(words):
    since = time.time()
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    return 1000 * (time.time() - since)


def metric(name):
    for line in text("/metrics").splitlines():
        if line.startswith(name + " "):
            return float(line.split()[1])


def raise_descriptors():
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(4096, hard), hard))


def many():
    """200 pages that are open at once, half of which are never read."""
    raise_descriptors()
    pid, words = rest[0], rest[1:]
    before = rss_kb(pid)
    pages = []
    for _ in range(200):
        s = dial()
        s.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
        pages.append(s)
    until(lambda: metric("radweb_streams") >= 190)
    readers = pages[:100]
    seen = [0] * 100

    def all_read_on():
        for s in select.select(readers, [], [], .2)[0]:
            seen[readers.index(s)] += s.recv(1 << 16).count(b"retry:")
        return min(seen) >= 3

    until(all_read_on)
    coordinator_ms(words)  # it answers
    grown = rss_kb(pid) - before
    assert grown < 64 << 10, grown
    # and no more than there may be
    more = []
    for _ in range(120):
        s = dial()
        s.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
        more.append(s)
    answers = b""
    for s in more[60:]:
        answers += s.recv(20)
    assert b" 503" in answers
    assert metric("radweb_streams") <= 250
    for s in pages + more:
        s.close()
    until(lambda: metric("radweb_streams") == 0)


def cpu_s(pid):
    f = open("/proc/%s/stat" % pid).read().rsplit(")", 1)[1].split()
    return (int(f[11]) + int(f[12])) / os.sysconf("SC_CLK_TCK")


def median(v):
    return sorted(v)[len(v) // 2]


FEW = 10000  # connections that are no flood


def connect_for_ten_seconds(made):
    held, begin = [], time.time()
    while time.time() < begin + 10 or made.value <= FEW:
        due = 10000 * (time.time() - begin)
        if made.value >= due:
            time.sleep(.002)
        for _ in range(int(min(due - made.value, 200))):
            s = socket.socket()
            s.setblocking(False)
            s.connect_ex(place)
            held.append(s)
            made.value += 1
        while len(held) > 600:
            held.pop(0).close()


def flood():
    """10,000 connections a second, or as many as can be made, for ten seconds or
    longer: radweb does next to nothing for them, and the coordinator answers
    (radctl gives up after 5 s)."""
    raise_descriptors()
    pid, words = rest[0], rest[1:]
    quiet = [coordinator_ms(words) for _ in range(15)]
    before, cpu, since = rss_kb(pid), cpu_s(pid), time.time()
    made, took = multiprocessing.Value("i", 0), []
    fork = multiprocessing.get_context("fork")  # runs no part a second time
    flooder = fork.Process(target=connect_for_ten_seconds, args=(made,))
    flooder.start()
    while flooder.is_alive():
        took.append(coordinator_ms(words))
        time.sleep(.1)
    flooder.join()
    cpu, since = cpu_s(pid) - cpu, time.time() - since
    until(alive)
    grown = rss_kb(pid) - before
    print("flood: %d connections; radctl status %.0f ms before, %.0f ms (at most "
          "%.0f of %d) meanwhile; radweb %.2f s of a processor, %d KiB more" %
          (made.value, median(quiet), median(took), max(took), len(took), cpu,
           grown))
    assert made.value > FEW, made.value
    assert grown < 64 << 10, grown
    assert cpu < .1 * since, cpu


def stalled():
    """radweb sleeps: the coordinator answers, or radctl gives up."""
    took = [coordinator_ms(rest) for _ in range(20)]
    print("stalled: radctl status %.0f ms, at most %.0f" %
          (median(took), max(took)))


def restart_begin():
    s = dial()
    s.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
    assert s.recv(100).startswith(b"HTTP/1.1 200")
    open(rest[0], "w").close()
    while True:
        if s.recv(1 << 16) == b"":
            return


def stream(path):
    """The events of a page, as they come."""
    s = dial()
    s.sendall(b"GET %s HTTP/1.1\r\nHost: localhost\r\n\r\n" % path.encode())
    said = ""
    while True:
        piece = s.recv(1 << 16)
        assert piece, "the stream has ended: " + said[-300:]
        said += piece.decode(errors="replace")
        yield said


def gone():
    """An open page of a job that is deleted says so, also a page that was not
    seen meanwhile, and had no stream; so does a bookmark."""
    path, words = "/jobs/" + rest[0], rest[1:]
    for _ in range(2):
        for said in stream(path + "/events"):
            if "This job is gone" in said:
                break
            if words and "<h1>" in said:
                subprocess.run(words, check=True)
                words = None
    r, body = get(path)
    assert r.status == 404 and b"no job" in body, body


def has_data():
    assert json.loads(text("/api/v1/status.json"))["age_s"] >= 0


def grows_old():
    """While the coordinator is away an open page tells how old its data are."""
    end = time.monotonic() + 300
    for said in stream("/events"):
        assert time.monotonic() < end, said[-300:]
        ages = set(re.findall(r"What is shown is ([^<]+) old", said))
        if len(ages) > 1:
            return


def comes_again():
    """A page that cannot be shown now is asked for again."""
    r, _ = get("/jobs/" + 32 * "1")
    assert r.status == 503 and r.getheader("Refresh"), r.status


def away():
    assert "cannot be asked" in text("/")
    assert not json.loads(text("/api/v1/status.json"))["up"]


def back():
    assert alive() and "cannot be asked" not in text("/")


def token():
    word = rest[0]
    assert get("/")[0].status == 401
    assert get("/metrics")[0].status == 401
    for bad in ("Bearer wrong", "Bearer " + word[:-1], "Bearer", "Basic !!",
                "Basic " + base64.b64encode(b"x:y").decode(),
                "Basic " + base64.b64encode(b"xy").decode()):
        assert get("/", {"Authorization": bad})[0].status == 401, bad
    for good in ("Bearer " + word, "Basic " +
                 base64.b64encode(b"me:" + word.encode()).decode()):
        assert get("/", {"Authorization": good})[0].status == 200, good
    assert get("/", {"Authorization": "Bearer " + word,
                     "Host": "render.example"})[0].status == 200


def tls():
    c = ssl.create_default_context()
    c.check_hostname = False
    c.verify_mode = ssl.CERT_NONE
    h = http.client.HTTPSConnection(*place, timeout=PATIENCE_S, context=c)
    h.request("GET", "/", headers={"Authorization": "Bearer " + rest[0]})
    assert h.getresponse().status == 200
    s = dial()
    s.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
    assert not s.recv(100).startswith(b"HTTP/1.1 200")


globals()[part]()
