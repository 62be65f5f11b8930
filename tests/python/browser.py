"""One Chromium for all pages: started once, asked through its developer tools, a tab of its own for each page.

To start it takes longer than to show a page. What a page asks of the network, what it says on the console and what stands in it
afterwards come by the protocol of the tools. Beside it the browser keeps its own list of requests, whoever made them: that one is
read at the end.
"""

import base64
import json
import shutil
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

from tornado.ioloop import IOLoop
from tornado.websocket import websocket_connect

CHROMIUM = next(filter(None, map(shutil.which, ["chromium", "chromium-browser", "google-chrome", "chrome"])), None)
PATIENCE_S = 120
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-extensions",
    "--hide-scrollbars",
    "--allow-file-access-from-files",
    "--host-resolver-rules=MAP * ~NOTFOUND",
    "--remote-debugging-port=0",
]
# What a page loads without asking anyone.
OWN_SCHEMES = ("file:", "data:", "about:", "blob:")


class Tab:
    """A page that the browser has loaded, and what it did meanwhile."""

    def __init__(self, browser: "Browser", session: str):
        self.browser = browser
        self.session = session
        self.console: list[str] = []
        self.requests: list[str] = []
        self.seen: set[str] = set()

    def ask(self, method: str, **parameters) -> dict:
        return self.browser.ask(method, self.session, **parameters)

    def take(self, event: str, of: dict) -> None:
        """What the browser tells without being asked."""
        self.seen.add(event)
        if event == "Network.requestWillBeSent":
            url = of["request"]["url"]
            if not url.startswith(OWN_SCHEMES):
                self.requests.append(url)
        elif event == "Runtime.exceptionThrown":
            details = of["exceptionDetails"]
            self.console.append(f"{details['text']} {details.get('exception', {}).get('description', '')}")
        elif event == "Runtime.consoleAPICalled":
            self.console.append(" ".join(str(argument.get("value", argument)) for argument in of["args"]))
        elif event == "Log.entryAdded":
            self.console.append(f"{of['entry']['text']} {of['entry'].get('url', '')}")

    def value(self, expression: str):
        """What an expression is in the page."""
        answer = self.ask("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def picture(self, file: Path) -> None:
        file.write_bytes(base64.b64decode(self.ask("Page.captureScreenshot")["data"]))


class Browser:
    """The browser, from its start to `close`."""

    def __init__(self, folder: Path):
        self.log = folder / "net.json"
        profile = folder / "profile"
        command = [CHROMIUM, *FLAGS, f"--user-data-dir={profile}", f"--log-net-log={self.log}", "about:blank"]
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.loop = IOLoop(make_current=False)
        self.tabs: dict[str, Tab] = {}
        self.answers: dict[int, dict] = {}
        self.number = 0
        port = profile / "DevToolsActivePort"
        deadline = time.monotonic() + PATIENCE_S
        while not (port.exists() and len(port.read_text().split()) == 2):
            assert self.process.poll() is None and time.monotonic() < deadline, "the browser does not start"
            time.sleep(0.02)
        number, path = port.read_text().split()
        address = f"ws://127.0.0.1:{number}{path}"
        self.line = self.loop.run_sync(lambda: websocket_connect(address, max_message_size=2**28), PATIENCE_S)

    def listen(self, until: Callable[[], bool]) -> None:
        while not until():
            text = self.loop.run_sync(self.line.read_message, PATIENCE_S)
            assert text is not None, "the browser has stopped"
            message = json.loads(text)
            if "id" in message:
                self.answers[message["id"]] = message
            elif tab := self.tabs.get(message.get("sessionId")):
                tab.take(message["method"], message["params"])

    def ask(self, method: str, session: str | None = None, **parameters) -> dict:
        self.number += 1
        number = self.number
        message = {"id": number, "method": method, "params": parameters}
        self.line.write_message(json.dumps(message | ({"sessionId": session} if session else {})))
        self.listen(lambda: number in self.answers)
        answer = self.answers.pop(number)
        assert "error" not in answer, (method, answer["error"])
        return answer["result"]

    def show(
        self, page: Path, width: int, scheme: str, virtual_ms: int = 0, look: Callable[[Tab], object] = lambda tab: None
    ) -> Tab:
        """Loads a page, lets its clocks run for `virtual_ms` as fast as they can, and looks at it."""
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        tab = Tab(self, self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"])
        for domain in ("Page", "Network", "Log", "Runtime"):
            tab.ask(f"{domain}.enable")
        tab.ask("Emulation.setDeviceMetricsOverride", width=width, height=3000, deviceScaleFactor=1, mobile=False)
        tab.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.tabs[tab.session] = tab
        tab.ask("Page.navigate", url=page.as_uri())
        self.listen(lambda: "Page.loadEventFired" in tab.seen)
        if virtual_ms:
            tab.ask("Emulation.setVirtualTimePolicy", policy="advance", budget=virtual_ms)
            self.listen(lambda: "Emulation.virtualTimeBudgetExpired" in tab.seen)
        look(tab)
        # Nothing that it has stored is there for the next.
        tab.ask("Storage.clearDataForOrigin", origin="file://", storageTypes="all")
        self.ask("Target.closeTarget", targetId=target)
        del self.tabs[tab.session]
        return tab

    def close(self) -> list[str]:
        """Ends the browser; what its pages have asked for from elsewhere by its own list."""
        try:
            self.line.write_message(json.dumps({"id": 0, "method": "Browser.close"}))
            self.process.wait(PATIENCE_S)
        finally:
            self.process.kill()
            self.line.close()
            self.loop.close()
        return requests_of_pages(self.log)


def requests_of_pages(log: Path) -> list[str]:
    """Addresses that pages asked for. The browser's own requests have no origin and do not count."""
    text = log.read_text(encoding="utf-8")
    # The browser may stop before it has closed the list.
    record = json.loads(text if text.rstrip().endswith("]}") or text.rstrip().endswith("}") else text.rstrip().rstrip(",") + "]}")
    started = record["constants"]["logEventTypes"]["URL_REQUEST_START_JOB"]
    starts = [event.get("params", {}) for event in record["events"] if event["type"] == started]
    asked = [start["url"] for start in starts if start.get("url") and start.get("initiator") != "not an origin"]
    return [url for url in asked if not url.startswith(("file:", "data:"))]
