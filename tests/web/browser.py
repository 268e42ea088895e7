"""browser.py - a headless Chromium, driven over the pipe that it offers

What is sent and answered is the DevTools protocol: JSON, each message ended by a
NUL byte, on the descriptors 3 and 4 of the browser's process.
"""
import base64
import json
import os
import shutil
import subprocess
import time


def program():
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if shutil.which(name):
            return shutil.which(name)
    return None


class Left(Exception):
    """The page went away before it answered: another one comes."""


class Browser:
    def __init__(self, folder):
        to_child, self.out = os.pipe()
        self.inp, from_child = os.pipe()

        def move():
            os.dup2(to_child, 103)
            os.dup2(from_child, 104)
            os.dup2(103, 3)
            os.dup2(104, 4)

        words = [program(), "--headless", "--disable-gpu", "--hide-scrollbars",
                 "--no-first-run", "--disable-dev-shm-usage",
                 "--disable-background-networking", "--remote-debugging-pipe",
                 "--user-data-dir=" + folder]
        if os.getuid() == 0:  # its own sandbox is not for root
            words.append("--no-sandbox")
        with open(folder + ".log", "wb") as log:
            self.process = subprocess.Popen(words, stdin=subprocess.DEVNULL,
                                            stdout=log, stderr=log,
                                            preexec_fn=move, close_fds=False)
        os.close(to_child)
        os.close(from_child)
        self.rest = b""
        self.number = 0
        self.events = []
        target = self.say("Target.createTarget", url="about:blank")["targetId"]
        self.session = None
        self.session = self.say("Target.attachToTarget", targetId=target,
                                flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.say(domain + ".enable")

    def read(self):
        while b"\0" not in self.rest:
            piece = os.read(self.inp, 1 << 20)
            if not piece:
                raise EOFError("the browser has ended")
            self.rest += piece
        text, self.rest = self.rest.split(b"\0", 1)
        return json.loads(text)

    def say(self, method, **params):
        self.number += 1
        m = {"id": self.number, "method": method, "params": params}
        if getattr(self, "session", None):
            m["sessionId"] = self.session
        os.write(self.out, json.dumps(m).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self.number:
                if "navigated" in str(answer.get("error", "")):
                    raise Left(method)
                if "error" in answer:
                    raise RuntimeError(method + ": " + str(answer["error"]))
                return answer["result"]
            self.events.append(answer)

    def size(self, width, height, dark=False):
        self.say("Emulation.setDeviceMetricsOverride", width=width,
                 height=height, deviceScaleFactor=1, mobile=width < 500)
        self.say("Emulation.setEmulatedMedia", features=[
            {"name": "prefers-color-scheme",
             "value": "dark" if dark else "light"}])

    def open(self, url):
        self.say("Page.navigate", url=url)
        self.until("document.readyState === 'complete'")

    def run(self, text):
        """The value of an expression in the page."""
        r = self.say("Runtime.evaluate", expression=text, awaitPromise=True,
                     returnByValue=True)
        if "exceptionDetails" in r:
            raise RuntimeError(text + ": " + str(r["exceptionDetails"]))
        return r["result"].get("value")

    def until(self, text, seconds=200):
        """Wait for an expression to be true, maybe in a page that comes."""
        end = time.time() + seconds
        while time.time() < end:
            try:
                value = self.run(text)
            except Left:
                value = None
            if value:
                return value
            time.sleep(.05)
        raise TimeoutError("never true: " + text)

    def pointer(self, kind, x, y):
        self.say("Input.dispatchMouseEvent", type=kind, x=x, y=y,
                 button="none" if kind == "mouseMoved" else "left",
                 clickCount=0 if kind == "mouseMoved" else 1)

    def middle(self, selector):
        """Where an element is, scrolled into view."""
        return self.run("""(() => {
            const e = document.querySelector(%s);
            e.scrollIntoView({block: "center"});
            const b = e.getBoundingClientRect();
            return [b.left + b.width / 2, b.top + b.height / 2];
        })()""" % json.dumps(selector))

    def click(self, selector):
        x, y = self.middle(selector)
        self.pointer("mousePressed", x, y)
        self.pointer("mouseReleased", x, y)

    def point(self, selector):
        self.pointer("mouseMoved", *self.middle(selector))

    def press(self, key):
        for kind in ("keyDown", "keyUp"):
            self.say("Input.dispatchKeyEvent", type=kind, key=key)

    def shoot(self, path):
        """The whole page."""
        m = self.say("Page.getLayoutMetrics")["cssContentSize"]
        r = self.say("Page.captureScreenshot", captureBeyondViewport=True,
                     clip={"x": 0, "y": 0, "width": m["width"],
                           "height": min(m["height"], 6000), "scale": 1})
        with open(path, "wb") as f:
            f.write(base64.b64decode(r["data"]))

    def complaints(self):
        """What the page and its policy complained of."""
        self.run("0")
        said = []
        for e in self.events:
            p = e.get("params", {})
            if e.get("method") == "Log.entryAdded":
                if p["entry"]["level"] == "error":
                    said.append(p["entry"]["text"])
            elif e.get("method") == "Runtime.exceptionThrown":
                said.append(str(p["exceptionDetails"]))
            elif e.get("method") == "Page.javascriptDialogOpening":
                said.append("dialog: " + p["message"])
        return said

    def close(self):
        try:
            self.session = None
            self.say("Browser.close")
        except (EOFError, OSError):
            pass
        self.process.wait(10)
