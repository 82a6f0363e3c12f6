#!/usr/bin/python3
"""Checks the links of a folder of HTML pages: check_links.py SITE.

Every target within the site exists, anchors included; no page loads anything from elsewhere; a link to elsewhere is for
the reader to follow and is not tried. Prints each that is wrong and ends with status 1.
"""

import os
import sys
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.anchors, self.links, self.loads = set(), [], []
        with open(path, encoding="utf-8") as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors.update(values[name] for name in ("id", "name") if values.get(name))
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])
        elif values.get("src"):
            self.loads.append(values["src"])
        elif tag == "link" and values.get("href"):
            self.loads.append(values["href"])


def main():
    site = sys.argv[1]
    pages = {}
    for folder, _, names in os.walk(site):
        for name in sorted(names):
            if name.endswith(".html"):
                path = os.path.join(folder, name)
                pages[os.path.normpath(path)] = Page(path)
    wrong, checked = [], 0
    for path, page in sorted(pages.items()):
        for target in page.links + page.loads:
            parts = urlsplit(target)
            where = f"{os.path.relpath(path, site)}: {target}"
            if parts.scheme or parts.netloc:
                if target in page.loads and parts.scheme != "data":
                    wrong.append(f"{where} is loaded from elsewhere")
                continue
            checked += 1
            other = os.path.normpath(os.path.join(os.path.dirname(path), unquote(parts.path))) if parts.path else path
            if not os.path.isfile(other):
                wrong.append(f"{where} does not exist")
            elif parts.fragment and other in pages and unquote(parts.fragment) not in pages[other].anchors:
                wrong.append(f"{where} has no such anchor")
    for line in wrong:
        print(line, file=sys.stderr)
    print(f"{len(pages)} pages, {checked} links, {len(wrong)} wrong")
    sys.exit(1 if wrong or len(pages) < 20 else 0)


main()
