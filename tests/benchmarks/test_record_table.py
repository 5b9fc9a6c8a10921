"""Tables of records: what a crash leaves of them is gone on with."""

from __future__ import annotations

from hunting.record_table import add_row, rows_of


def test_a_line_that_a_crash_cut_off_is_written_again(tmp_path):
    path = tmp_path / "table.csv"
    assert rows_of(path) == []
    add_row(path, ("index", "kind"), {"kind": "late", "index": 0})
    add_row(path, ("index", "kind"), {"kind": "fine, so far", "index": 1})
    whole = path.read_bytes()
    path.write_bytes(whole + b"2,la")
    known = [{"index": "0", "kind": "late"}, {"index": "1", "kind": "fine, so far"}]
    assert rows_of(path) == known
    assert path.read_bytes() == whole
    add_row(path, ("index", "kind"), {"kind": "late", "index": 2})
    assert rows_of(path) == [*known, {"index": "2", "kind": "late"}]
