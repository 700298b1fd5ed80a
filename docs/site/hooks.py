# SPDX-License-Identifier: MIT
"""What mkdocs lacks for this site: the order of docs/index.md, links as GitHub writes them, a search without a server."""
import json
import re
import shutil
from pathlib import Path


def navigation(pages):
    """The groups of docs/index.md: its headings, and the link that begins each item of their lists."""
    groups = [{"Contact Spline": "README.md"}, {"All pages": "docs/index.md"}]
    for line in (pages / "docs/index.md").read_text().splitlines():
        if line.startswith("## "):
            groups.append({line[3:]: []})
        for title, page in re.findall(r"^- \[([^]]+)\]\(([^)]+)\)", line):
            [items] = groups[-1].values()
            items.append({title: "docs/" + page})
    return groups + [{"Project": [{"Contributing": "CONTRIBUTING.md"}, {"Changelog": "CHANGELOG.md"}]}]


def anchor(heading, separator):
    """The anchor of a heading as GitHub writes it, which tests/source/pages_test.cpp checks."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", separator)


def on_config(config):
    config["nav"] = navigation(Path(config["docs_dir"]))
    config["mdx_configs"]["toc"] = {"slugify": anchor}
    config["extra"]["page"] = (Path(config["docs_dir"]) / "page/index.html").exists()
    return config


def on_page_markdown(markdown, page, config, files):
    """A link to a sound becomes a player; the page of scripts/web takes the place of its figure, where there is one."""
    if config["extra"]["page"]:
        markdown = re.sub(r"!\[.*\]\(../figures/web\.png\)", '<iframe class="page" src="../../page/index.html"></iframe>', markdown)
    return re.sub(r"\[([^]]+)\]\(([^)]+\.ogg)\)", r'<audio controls preload="none" src="\2"></audio>\1', markdown)


def on_post_build(config):
    """The sections of all pages as a script, which a browser loads from a disk as well; it replaces mkdocs' search."""
    site = Path(config["site_dir"])
    sections, page = [], ""
    for entry in json.loads((site / "search/search_index.json").read_text())["docs"]:
        if "#" not in entry["location"]:
            page = entry["title"]  # its text is that of its sections
        else:
            title = entry["title"] if entry["title"] == page else f"{page}: {entry['title']}"
            sections.append({"url": entry["location"], "title": title, "text": entry["text"]})
    (site / "sections.js").write_text("window.sections = " + json.dumps(sections))
    shutil.rmtree(site / "search")
