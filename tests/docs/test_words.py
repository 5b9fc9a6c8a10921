from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from pages import PAGES, ROOT, name_of

SOURCE = ROOT / "src" / "radmpc"
THIS = Path(__file__).resolve()
GLOSSARY = ROOT / "docs" / "glossary.md"
SPELLED = {".py", ".md", ".toml", ".yml"}

BRITISH = {
    r"(an|para|cata)lyse[ds]?": "analyze",
    r"arte?fact(?=s?\b)(?<=arte.{4})": "artifact",
    r"behaviou?r(?<=our)(al|s)?": "behavior",
    r"(kilo|centi|milli)?metres?": "meter",
    r"(centre[ds]?|centring)": "center",
    r"(dis)?colour(ed|s|ing|less|ful)?": "color",
    r"defence|offence|pretence": "defense",
    r"favour(s|ed|ing|able|ite)?": "favor",
    r"fulfil(s|ment)?": "fulfill",
    r"grey(s|ed|ish)?": "gray",
    r"honour(s|ed|ing)?": "honor",
    r"(judge|acknowledge)ment(?<=gement)": "judgment",
    r"licen[c]e[ds]?": "license",
    r"(learnt|spelt|dreamt|burnt)": "learned",
    r"(label|model|travel|signal|tunnel|channel|fuel)l(ed|ing|er|ers)": "one l",
    r"manoeuvr\w*": "maneuver",
    r"neighbour(s|ed|ing|hood|hoods|ly)?": "neighbor",
    r"plough\w*": "plow",
    r"programmes?": "program",
    r"sceptic\w*": "skeptic",
    r"(to|after|back|for|up|down|in|out)wards": "toward",
    r"whilst|amongst": "while",
    r"\w+[^aeiou\W]is(e|ed|es|ing|ation|ations)(?<=[^v]\b)": "",
}
"""What is British, as a regular expression of whole words, and what it is here."""
