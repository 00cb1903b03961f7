"""Make the plots' font: `python tools/subset_font.py SOURCE.ttc`.

Source: NotoSansCJK-Regular.ttc, version 2.004 (Debian package ``fonts-noto-cjk``), SIL Open Font License 1.1.
The subset keeps what the plots can show and is renamed, because a cut-down font must not pass for the
original. The same source gives the same bytes.
"""

import sys
from pathlib import Path

from fontTools import subset
from fontTools.ttLib import TTCollection, TTFont

FAMILY = "Grader Sans SC"
FACE = "Noto Sans CJK SC"
TARGET = Path(__file__).parent.parent / "grader" / "render" / "fonts" / "GraderSansSC-Regular.otf"
SYMBOLS = "−–—―‘’“”…‰′″←↑→↓↗↘≈≠≤≥∞√∠△□○●◇◆★☆✓✗•·×÷±°º²³µΩπθωφΔαβ①②③④⑤⑥⑦⑧⑨⑩"


def glyphs_wanted() -> set[int]:
    """Return the code points kept: ASCII, Latin-1, symbols, Chinese punctuation, GB 2312 level 1."""
    wanted = {*range(0x20, 0x7F), *range(0xA0, 0x100), *map(ord, SYMBOLS)}
    wanted |= {*range(0x3000, 0x3018), *range(0xFF01, 0xFF5F), 0xFFE5}
    level_1 = range(0xB0, 0xD8)
    for row in level_1:
        for cell in range(0xA1, 0xFF):
            wanted.update(map(ord, bytes((row, cell)).decode("gb2312", errors="ignore")))
    return wanted


def face(collection: Path) -> TTFont:
    """Return the Simplified Chinese face of the collection."""
    fonts = TTCollection(str(collection)).fonts
    return next(font for font in fonts if font["name"].getDebugName(1) == FACE)


def rename(font: TTFont) -> None:
    """Give the subset its own family name, also inside the CFF table."""
    postscript = FAMILY.replace(" ", "") + "-Regular"
    names = {1: FAMILY, 2: "Regular", 3: postscript, 4: FAMILY, 6: postscript, 16: FAMILY, 17: "Regular"}
    for record in list(font["name"].names):
        if record.nameID in names:
            record.string = names[record.nameID]
    cff = font["CFF "].cff
    cff.fontNames = [postscript]
    cff.topDictIndex[0].FamilyName = FAMILY
    cff.topDictIndex[0].FullName = FAMILY


def main(source: Path) -> None:
    """Write the subset of `source` to `TARGET`."""
    options = subset.Options(
        layout_features=["kern"], hinting=False, name_IDs=[0, 1, 2, 3, 4, 5, 6, 13, 14], notdef_outline=True
    )
    options.drop_tables += ["BASE", "vhea", "vmtx", "VORG", "GSUB", "DSIG"]
    font = face(source)
    font.recalcTimestamp = False
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=glyphs_wanted())
    subsetter.subset(font)
    rename(font)
    TARGET.parent.mkdir(parents=True, exist_ok=True)
    font.save(TARGET)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
