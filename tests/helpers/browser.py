"""A real browser without a window, driven over a pipe by the Chrome DevTools protocol. It opens no port and needs no driver."""

import base64
import contextlib
import io
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from PIL import Image

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    "--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run", "--disable-extensions",
    "--disable-background-networking", "--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader",
    "--disable-smooth-scrolling", "--hide-scrollbars", "--window-size=1200,900",
)  # fmt: skip
PATIENCE = 600.0  # s, a last resort for any answer
KEYS = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "0": 48, "n": 78, "p": 80, "+": 187}


def find_browser() -> str | None:
    """Return the path of an installed Chromium or Chrome; None if neither is installed."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Browser:
    """One page. `errors`: errors of the console, exceptions and refusals of the page's security policy since the page was opened."""

    def __init__(self, program: str) -> None:
        self.errors: list[str] = []
        self.requests: list[str] = []
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        theirs, self._into = os.pipe()
        self._out_of, writes = os.pipe()
        self._number, self._session, self._waiting = 0, "", b""
        # The browser reads file descriptor 3 and writes file descriptor 4. A shell connects them to ours, whatever our numbers are.
        script = f'exec "$@" 3<&{theirs} 4>&{writes}'
        self._process = subprocess.Popen(
            ["/bin/bash", "-c", script, "browser", program, *FLAGS, f"--user-data-dir={self._profile.name}", "about:blank"],
            pass_fds=(theirs, writes), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(theirs)
        os.close(writes)

    def __enter__(self) -> Self:
        (page,) = [target for target in self.send("Target.getTargets")["targetInfos"] if target["type"] == "page"]
        self._session = self.send("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        os.close(self._into)
        try:
            self._process.wait(10.0)  # the browser ends when its pipe closes
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._out_of)
        self._profile.cleanup()

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command and return its answer."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters} | ({"sessionId": self._session} if self._session else {})
        os.write(self._into, json.dumps(message).encode() + b"\0")
        while (answer := self._next()).get("id") != self._number:
            self._hear(answer)
        assert "error" not in answer, (method, answer)
        return dict(answer["result"])

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._waiting:
            readable, _, _ = select.select([self._out_of], [], [], PATIENCE)
            read = os.read(self._out_of, 1 << 20) if readable else b""
            assert read, "the browser does not answer"
            self._waiting += read
        first, _, self._waiting = self._waiting.partition(b"\0")
        return dict(json.loads(first))

    def _hear(self, event: dict[str, Any]) -> None:
        parameters = event.get("params", {})
        if event["method"] == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(parameters["exceptionDetails"]))
        elif event["method"] == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "assert"):
            self.errors.append(json.dumps(parameters["args"]))
        elif event["method"] == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.errors.append(parameters["entry"]["text"])
        elif event["method"] == "Network.requestWillBeSent":
            self.requests.append(parameters["request"]["url"])

    def open(self, page: Path) -> None:
        """Load a file and wait for it."""
        self.errors.clear()
        self.requests.clear()
        self.send("Page.navigate", url=page.resolve().as_uri())
        self.wait(f"document.readyState === 'complete' && location.pathname.endsWith({json.dumps(page.name)})")

    def value(self, expression: str) -> Any:
        """Return the value of an expression in the page. The debugger computes it, which the page's security policy does not restrict."""
        answer = self.send("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in answer, (expression, answer)
        return answer["result"].get("value")

    def wait(self, condition: str) -> None:
        """Wait until an expression is true."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            with contextlib.suppress(AssertionError):  # the browser is still leaving the page before
                if self.value(f"Boolean({condition})"):
                    return
            time.sleep(0.02)
        raise AssertionError(f"never came true: {condition}; {self.errors}")

    def box(self, selector: str) -> tuple[float, float, float, float]:
        """Scroll to an element, and return its left, top, width and height in pixels of the window."""
        corner = f"document.querySelector({json.dumps(selector)})"
        self.value(f"{corner}.scrollIntoView({{block: 'center', behavior: 'instant'}})")
        found = self.value(f"(({{x, y, width, height}}) => [x, y, width, height])({corner}.getBoundingClientRect())")
        return (found[0], found[1], found[2], found[3])

    def click(self, selector: str) -> None:
        """Click in the middle of an element."""
        x, y, width, height = self.box(selector)
        self.drag((x + width / 2, y + height / 2), (x + width / 2, y + height / 2))

    def drag(self, start: tuple[float, float], end: tuple[float, float], button: str = "left") -> None:
        """Press a mouse button at one place of the window, and release it at another place."""
        held = {"left": 1, "right": 2}[button]
        middle = tuple((a + b) / 2 for a, b in zip(start, end, strict=True))
        for kind, (x, y), buttons in (
            ("mouseMoved", start, 0), ("mousePressed", start, held), ("mouseMoved", middle, held), ("mouseMoved", end, held),
            ("mouseReleased", end, 0),
        ):  # fmt: skip
            own = "none" if kind == "mouseMoved" and not buttons else button
            self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=own, buttons=buttons, clickCount=1)

    def swipe(self, starts: list[tuple[float, float]], ends: list[tuple[float, float]]) -> None:
        """Move one or several fingers over the window."""
        for kind, places in (("touchStart", starts), ("touchMove", ends), ("touchEnd", [])):
            fingers = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(places)]
            self.send("Input.dispatchTouchEvent", type=kind, touchPoints=fingers)

    def wheel(self, place: tuple[float, float], amount: float) -> None:
        """Turn the mouse wheel at a place of the window."""
        self.send("Input.dispatchMouseEvent", type="mouseWheel", x=place[0], y=place[1], deltaX=0, deltaY=amount)

    def press(self, key: str, shift: bool = False) -> None:
        """Press and release a key."""
        text = {"text": key} if len(key) == 1 else {}
        code = {"key": key, "windowsVirtualKeyCode": KEYS[key], "modifiers": 8 * shift}
        self.send("Input.dispatchKeyEvent", type="keyDown", **code, **text)
        self.send("Input.dispatchKeyEvent", type="keyUp", **code)

    def picture(self, selector: str) -> np.ndarray:
        """Return an image of an element, (height, width, 3) in 0 ... 255."""
        x, y, width, height = self.box(selector)
        frames = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))"
        self.send("Runtime.evaluate", expression=frames, awaitPromise=True)
        scroll = self.value("[scrollX, scrollY]")
        clip = {"x": x + scroll[0], "y": y + scroll[1], "width": width, "height": height, "scale": 1}
        taken = self.send("Page.captureScreenshot", format="png", clip=clip)
        return np.array(Image.open(io.BytesIO(base64.b64decode(taken["data"]))).convert("RGB"))
