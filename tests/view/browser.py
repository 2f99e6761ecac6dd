"""Chromium without a window, driven over a pipe by its DevTools protocol: no port, no driver, no network."""
# SPDX-License-Identifier: BSD-3-Clause

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

# The network is a name that does not resolve, and WebGL is computed in software.
OPTIONS = [
    "--headless", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--host-resolver-rules=MAP * ~NOTFOUND", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-default-apps", "--no-first-run",
    "--no-default-browser-check", "--metrics-recording-only", "--remote-debugging-pipe", "--hide-scrollbars",
]  # fmt: skip


def find():
    """The program, or None."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


class Browser:
    def __init__(self, width=1500, height=900):
        self.profile = tempfile.mkdtemp(prefix="ilaw_view_")
        to_browser, commands = os.pipe()
        answers, from_browser = os.pipe()

        # The protocol reads file 3 and writes file 4. Copies first: either may be one of both already.
        def connect():
            read, written = os.dup(to_browser), os.dup(from_browser)
            low, high = os.dup(read), os.dup(written)
            os.dup2(low, 3), os.dup2(high, 4)

        options = [*OPTIONS, f"--user-data-dir={self.profile}", f"--window-size={width},{height}", "about:blank"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self.process = subprocess.Popen([find(), *options], preexec_fn=connect, close_fds=False, **quiet)
        os.close(to_browser), os.close(from_browser)
        self.commands, self.answers, self.rest, self.number = commands, answers, b"", 0
        self.complaints, self.addresses = [], []
        target = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(timeout=20)
        os.close(self.commands), os.close(self.answers)
        shutil.rmtree(self.profile, ignore_errors=True)

    def call(self, method, seconds=120, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if getattr(self, "session", None):
            message["sessionId"] = self.session
        text = json.dumps(message).encode() + b"\0"
        while text:
            text = text[os.write(self.commands, text) :]
        end = time.monotonic() + seconds
        while True:
            answer = self.read(end, method)
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.note(answer)

    def read(self, end, method):
        while b"\0" not in self.rest:
            if not select.select([self.answers], [], [], max(0.0, end - time.monotonic()))[0]:
                raise TimeoutError(f"{method}: no answer of the browser")
            part = os.read(self.answers, 1 << 20)
            if not part:
                raise RuntimeError(f"{method}: the browser has ended")
            self.rest += part
        text, _, self.rest = self.rest.partition(b"\0")
        return json.loads(text)

    def note(self, event):
        method, found = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = found["exceptionDetails"]
            self.complaints.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and found["type"] in ("error", "warning", "assert"):
            self.complaints.append(" ".join(str(a.get("value", a.get("description"))) for a in found["args"]))
        elif method == "Log.entryAdded" and found["entry"]["level"] in ("error", "warning"):
            self.complaints.append(found["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.addresses.append(found["request"]["url"])

    def open(self, page):
        self.call("Page.navigate", url=Path(page).resolve().as_uri())
        end = time.monotonic() + 120
        while self.evaluate("document.readyState") != "complete":
            if time.monotonic() > end:
                raise TimeoutError(f"{page}: not loaded within two minutes")
            time.sleep(0.1)

    def evaluate(self, script):
        """Value of an expression; a promise is awaited."""
        result = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            details = result["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return result["result"].get("value")

    def screenshot(self, file):
        Path(file).write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))
