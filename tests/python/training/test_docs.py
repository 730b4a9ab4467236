"""docs/training.md and docs/hooks.md: their Python runs, and what they name is there."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest

PAGES = ("training", "hooks")


@pytest.mark.parametrize("page", PAGES)
def test_blocks_run(repo_dir, tmp_path, page):
    """One after the other, in one process, from the root of the repository; blocks that begin with
    the name of a file are that file."""
    text = (repo_dir / "docs" / f"{page}.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    assert len(blocks) >= 3
    run = []
    for code in blocks:
        file = re.match(r"# (\w+\.py)\n", code)
        if file:
            (tmp_path / file[1]).write_text(code)
        else:
            run.append(code.replace("/tmp/", f"{tmp_path}/"))
    assert len(run) >= 3
    (tmp_path / "blocks.py").write_text("\n".join(run))
    done = subprocess.run(
        [sys.executable, str(tmp_path / "blocks.py")],
        cwd=repo_dir,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("page", PAGES)
def test_the_readme_leads_there(repo_dir, page):
    assert f"(docs/{page}.md)" in (repo_dir / "README.md").read_text()
