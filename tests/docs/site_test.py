#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the site promises: every page opens from a folder, without a network.   site_test.py SITE"""
import html.parser
import pathlib
import re
import sys
import unittest
import urllib.parse

SITE = pathlib.Path(sys.argv.pop()).resolve() if len(sys.argv) > 1 else pathlib.Path("out/site")


class Page(html.parser.HTMLParser):
    """What a page refers to, and the places in it."""

    def __init__(self, path):
        super().__init__()
        self.refers, self.places, self.scripts = [], set(), 0
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        self.scripts += tag in ("script", "iframe", "object", "embed")
        for name, value in attributes:
            if name in ("href", "src", "srcset", "action", "data"):
                self.refers.append(value)
            if name in ("id", "name") and value:
                self.places.add(value)


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.pages = {p: Page(p) for p in SITE.rglob("*.html")}

    def test_it_has_all_parts(self):
        names = {p.name for p in self.pages}
        self.assertLessEqual({"index.html", "gallery.html", "c.html", "python-reference.html",
                              "method.html"}, names)
        pictures = list((SITE / "gallery").glob("*.png"))
        self.assertGreater(len(pictures), 20)
        for picture in pictures:
            self.assertGreater(picture.stat().st_size, 10000, picture)

    def test_no_page_refers_to_the_network(self):
        wrong = []
        for path, page in self.pages.items():
            wrong += [f"{path.name}: {r}" for r in page.refers
                      if urllib.parse.urlsplit(r).scheme or r.startswith(("//", "/"))]
            wrong += [f"{path.name}: a script or frame"] if page.scripts else []
        for path in SITE.rglob("*.css"):
            wrong += [f"{path.name}: {found}" for found in re.findall(
                r"@import.*|url\(.*?\)", path.read_text(encoding="utf-8"))]
        self.assertEqual(wrong, [])

    def test_every_link_leads_somewhere(self):
        dead = []
        for path, page in self.pages.items():
            for refers in page.refers:
                target = urllib.parse.urlsplit(refers)
                file = (path.parent / urllib.parse.unquote(target.path)).resolve() if target.path else path
                there = file.is_file() and (
                    not target.fragment or file not in self.pages
                    or urllib.parse.unquote(target.fragment) in self.pages[file].places)
                if not there:
                    dead.append(f"{path.name}: {refers}")
        self.assertEqual(dead, [])


if __name__ == "__main__":
    unittest.main()
