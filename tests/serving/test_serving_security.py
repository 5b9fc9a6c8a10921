"""Each threat of docs/serving.md, tried."""

from __future__ import annotations

import json
import os
import socket
import tempfile
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import pytest
from served import CallFailedError, Site
from websockets.exceptions import ConnectionClosed, InvalidStatus

from radmpc.serving.failures import CallError
from radmpc.serving.folder import Folder
from radmpc.serving.protocol import REFUSED
from radmpc.serving.starting import listening
from radmpc.serving.web import socket as pages
from radmpc.serving.web.guard import Guard, Rate

UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}
OUTSIDE = [
    "../secret.yaml", "/etc/passwd.yaml", "a/../../secret.yaml", "..", "", ".", "./../secret.yaml",
    "C:\\secret.yaml", "..\\secret.yaml", ".hidden.yaml", "a/.hidden/x.yaml", "x.yaml\0.txt",
    "x\n.yaml", "//x.yaml", "a//x.yaml", "x.py", "x.yaml/", "link.yaml", "linked/x.yaml",
    "harmless.yaml", "%2e%2e/secret.yaml", "~/x.yaml", "x" * 400 + ".yaml", "file:x.yaml", 3, None,
    "x" * 280 + ".yaml", "ü" * 140 + ".yaml",
]  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    inside, outside = tmp_path / "in", tmp_path / "out"
    inside.mkdir()
    outside.mkdir()
    for place in (tmp_path / "secret.yaml", outside / "x.yaml", inside / "own.yaml"):
        place.write_text("format: radmpc/scenario/1\n", encoding="utf-8")
    (inside / "link.yaml").symlink_to(tmp_path / "secret.yaml")
    (inside / "linked").symlink_to(outside)
    (inside / "harmless.yaml").symlink_to("/dev/null")
    (inside / "x.py").write_text("print()", encoding="utf-8")
    return Folder(inside)


def test_it_listens_on_this_machine_alone():
    with listening(0) as port:
        assert port.getsockname()[0] == "127.0.0.1"
        assert port.family == socket.AF_INET


@pytest.mark.parametrize("host", ["evil.example", "evil.example:{port}", "127.0.0.1", "", "[::1]"])
def test_another_host_is_turned_down_whatever_it_asks(site, host):
    said = host.format(port=site.guard.port)
    status, _, text = site.get("/", Host=said)
    assert status in {400, 403}
    assert "token" not in text
    path = f"/socket?token={site.guard.token}"
    assert site.get(path, Host=said, **UPGRADE)[0] in {400, 403}


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1"]
)
def test_a_socket_of_another_origin_is_turned_down(site, origin):
    said = origin.format(port=site.guard.port)
    with pytest.raises(InvalidStatus) as caught, site.connect(origin=said):
        pass
    assert caught.value.response.status_code == 403


def test_our_own_origin_is_let_in(site):
    with site.connect(origin=f"http://127.0.0.1:{site.guard.port}") as line:
        line.ping()


@pytest.mark.parametrize("token", ["", "x", "ü", "0" * 43, "0" * 4000])
def test_another_token_is_turned_down_before_anything_is_said(site, token):
    with site.connect(token=token) as line:
        with pytest.raises(ConnectionClosed):
            line.recv(timeout=10)
        assert line.close_code == REFUSED


def test_tokens_are_long_and_new_at_every_start():
    tokens = {Guard(1).token for _ in range(20)}
    assert len(tokens) == 20
    assert all(len(token) >= 43 for token in tokens)


def test_answers_tell_browsers_to_refuse_what_is_not_ours(site):
    for path in ("/", "/page.js", "/nothing"):
        _, headers, _ = site.get(path)
        policy = headers["content-security-policy"]
        assert "script-src 'self';" in policy
        assert "default-src 'none'" in policy
        assert "frame-ancestors 'none'" in policy
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["referrer-policy"] == "no-referrer"
        assert headers["cross-origin-resource-policy"] == "same-origin"
        assert headers["cache-control"] == "no-store"
        assert "access-control-allow-origin" not in headers
        assert "server" not in headers


@pytest.mark.parametrize(
    "path",
    ["/../guard.py", "/%2e%2e/starting.py", "/..%2fstarting.py", "/__init__.py", "/%00", "/.x",
     "/page.css/../../starting.py", "/assets/page.js", "/socket"],
)  # fmt: skip
def test_the_server_serves_the_bundle_and_nothing_else(site, path):
    status, _, text = site.get(path)
    assert status in {400, 404}
    assert "import" not in text


def test_a_name_that_no_file_can_have_is_not_found(tmp_path, quiet_crew):
    (tmp_path / "bundle").mkdir()
    with Site(tmp_path, tmp_path / "bundle") as site:
        assert site.get(f"/{'x' * 300}.js")[0] == 404


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "TRACE"])
def test_requests_change_nothing(site, method):
    assert site.get("/", method)[0] == 405


@pytest.mark.parametrize("path", OUTSIDE)
def test_no_file_outside_the_folder_is_read_or_written(folder, path):
    for ask in (folder.readable, folder.writable):
        with pytest.raises(CallError) as caught:
            ask(path, ".yaml", **({"overwrite": True} if ask == folder.writable else {}))
        assert str(folder.root) not in str(caught.value)
        assert caught.value.kind == "refused"


def test_files_of_the_folder_are_read_written_and_listed(folder):
    assert folder.readable("own.yaml", ".yaml").name == "own.yaml"
    folder.write(folder.writable("new.yaml", ".yaml"), "format: radmpc/scenario/1\n")
    with pytest.raises(CallError, match="there already"):
        folder.writable("own.yaml", ".yaml")
    with pytest.raises(CallError, match="no such folder"):
        folder.writable("nowhere/own.yaml", ".yaml")
    assert [entry["path"] for entry in folder.files()] == ["new.yaml", "own.yaml"]


def test_a_file_whose_name_no_page_can_be_told_is_not_listed(folder):
    os.close(os.open(os.fsencode(folder.root) + b"/k\xfcste.kml", os.O_CREAT))
    (folder.root / "coast.kml").touch()
    assert [entry["path"] for entry in folder.files()] == ["coast.kml", "own.yaml"]


def test_a_file_that_cannot_be_written_is_told_without_its_place(folder, monkeypatch):
    place = folder.writable("new.yaml", ".yaml")

    def full(path, text):
        raise OSError(28, os.strerror(28), os.fspath(path))

    monkeypatch.setattr("radmpc.serving.folder.write_text", full)
    with pytest.raises(CallError, match=r"^new\.yaml: No space left on device$"):
        folder.write(place, "")


@pytest.mark.parametrize(
    "message",
    ["", "[]", "x", '{"id": "1", "call": "hello"}', '{"id": true}', "1" * 10000, "[" * 100000,
     '{"id": 1, "call": "hello", "args": NaN}', b"\x80\x04."],
)  # fmt: skip
def test_what_is_no_call_ends_the_socket_and_not_the_server(site, message):
    with site.connect() as line:
        line.send(message)
        with pytest.raises(ConnectionClosed, match="not a call"):
            line.recv(timeout=10)
    assert line.close_code == 1003
    assert site.page().call("files") == []


@pytest.mark.parametrize(
    ("name", "args"),
    [
        ("nothing", {}), ("__class__", {}), (None, {}), (["hello"], {}), ("files", []),
        ("state", {}), ("state", {"document": {"$ne": 1}}), ("new", {"template": "../harbor"}),
        ("open", {"path": ["a"]}), ("drop", {"name": "x.exe", "content": "", "into": None}),
        ("drop", {"name": "x.yaml", "content": "a" * (4 * 2**20 + 1), "into": None}),
        ("drop", {"name": "x.yaml", "content": "!!python/object/apply:os.system [id]",
                  "into": None}),
        ("drop", {"name": "x.json", "content": "\x80\x04", "into": None}),
    ],
)  # fmt: skip
def test_nonsense_is_refused_in_words(site, name, args):
    page = site.page()
    page.socket.send(json.dumps({"id": 1, "call": name, "args": args}))
    failure = page.receive()["failure"]
    assert failure["kind"] in {"refused", "gone"}
    assert tempfile.gettempdir() not in failure["text"]


def test_a_message_that_is_too_long_ends_the_socket(tmp_path, quiet_crew, monkeypatch):
    assert pages.MOST_BYTES == 24 * 2**20
    monkeypatch.setattr("radmpc.serving.web.listener.MOST_BYTES", 2**20)
    with Site(tmp_path) as site, site.connect() as line:
        # The server may have closed before all of it was sent.
        with suppress(ConnectionClosed):
            line.send("x" * (2**20 + 1))
        with pytest.raises(ConnectionClosed):
            line.recv(timeout=30)
    assert line.close_code == 1009


def test_calls_beyond_the_rate_are_refused_and_the_page_goes_on(site, monkeypatch):
    monkeypatch.setattr(pages, "_PER_SECOND", 0.0)
    monkeypatch.setattr(pages, "_AT_ONCE", 3.0)
    page = site.page()
    for _ in range(3):
        page.call("files")
    with pytest.raises(CallFailedError, match="too many calls") as caught:
        page.call("files")
    assert caught.value.kind == "limit"


def test_a_bucket_fills_at_its_rate(monkeypatch):
    now = [0.0]
    # The guard's clock alone: a server that is ending waits by that of the process, for ever if it
    # stands still.
    clock = SimpleNamespace(monotonic=lambda: now[0])
    monkeypatch.setattr("radmpc.serving.web.guard.time", clock)
    rate = Rate(2.0, 3.0)
    assert [rate.takes() for _ in range(4)] == [True, True, True, False]
    now[0] += 0.5
    assert [rate.takes(), rate.takes()] == [True, False]


def test_pages_beyond_the_limit_are_let_go(site, monkeypatch):
    monkeypatch.setattr(pages, "_MOST_PAGES", 1)
    site.page().call("files")
    with site.connect() as line, pytest.raises(ConnectionClosed):
        line.recv(timeout=10)


def test_a_defect_is_told_without_what_it_says(site, monkeypatch):
    def broken(self):
        raise RuntimeError("somebody's secret")

    monkeypatch.setattr(Folder, "files", broken)
    with pytest.raises(CallFailedError, match=r"^internal error: RuntimeError$") as caught:
        site.page().call("files")
    assert caught.value.kind == "internal"


def test_documents_have_a_largest_size_and_number(site, monkeypatch):
    monkeypatch.setattr("radmpc.serving.documents.content._MOST_BYTES", 2000)
    page = site.page()
    state = page.call("new", template=None)
    with pytest.raises(CallFailedError, match="must be at most"):
        page.call(
            "change", document=state["document"], revision=0, label="",
            changes=[{"path": ["source"], "value": {"a": "x" * 3000}}],
        )  # fmt: skip
    monkeypatch.setattr("radmpc.serving.desk.desk._MOST_DOCUMENTS", 1)
    with pytest.raises(CallFailedError, match="close one") as caught:
        page.call("new", template=None)
    assert caught.value.kind == "limit"
    page.call("close", document=state["document"])
    with pytest.raises(CallFailedError, match="any more") as gone:
        page.call("state", document=state["document"])
    assert gone.value.kind == "gone"
    page.call("new", template="boats")


def test_without_a_bundle_the_page_says_how_to_build_it(site):
    status, headers, text = site.get("/")
    assert status == 200
    assert headers["content-type"].startswith("text/html")
    assert "make page" in text
    assert "<script" not in text
