#!/usr/bin/env python3
"""scripts/thesis_page PEERD REPOSITORY OUT [--quick]: the page of scripts/thesis. PEERD_CORPUS may name a folder of real objects."""
import os
import pathlib
import sys

import appendix_a
import bouncing
import chapter3
import chapter4
import objects
from page import page
from product import Product, progress

# DESIGN: equations of the thesis, with its slips mended; tests hold the program to the mended ones.
SLIPS = (
    "Equation 4.4 has the wrong sign on x₋₁, and 4.6 the wrong factor on x₀: derived from the parabola through three positions it is "
    "(4δ₋₁ + 2δ₋₂) / (δ₋₁ + δ₋₂).",
    "Equation 4.7 leaves out |z| = 10π, between its cases; here it belongs to the second, as |z| = 20π does: derivatives at the turns are from the right.",
    "Collisions of the test scenario are printed at z = 10π and (20 + 5i)π with i = 0 … 4: z runs from 0 to −40π, so it is |z|; the last is where the drive ends.",
    "The remote cubes are printed at z = 27.5π, 32.5π and 37.5π: they stand at −27.5π, −32.5π and −37.5π, where the car passes them by 0.19 m.",
    "Equation 4.10 drops the δ subscripts: the distance at time δ is |Qδ − Pδ|.",
    "Listing 3.4 forgets the case where only the second tree has children, and returns nothing where volumes do not overlap.",
    "Listing 3.3 calls the field `collisionInterests` that appendix C.1 calls `interests`: both are read. `enslaved` and `remote` are SFBool, not SFFloat.",
    "Figures A.10 to A.12 are captioned “with remote collision prediction”; the text and the threshold of 0.01 m say that tracking is applied too. That "
    "threshold is an error-based one, which the captions call “close proximity threshold”, a time in definition 6.",
)


def introduction(chosen, quick):
    real = [o.name for o in chosen if o.origin != "generated"]
    return ["J. Ohlenburg, Efficient Collision Detection for Dynamic Objects in Distributed Virtual Environments, Diplomarbeit, 2003 (“the "
            "thesis”): its tables and figures of chapters 3 and 4 and of appendix A, from peerd's own commands, beside the printed numbers. Grey columns are "
            "the thesis's. Below each is how it deviates, in a line each.",
            (f"Objects: {', '.join(real)} of a corpus, the others generated." if real else "Objects are generated: no corpus (PEERD_CORPUS) was given.") +
            (" This is the quick form: small objects and few steps, to see that all works; its numbers are not to be compared." if quick else "")]


def main():
    words = [w for w in sys.argv[1:] if w != "--quick"]
    if len(words) != 3:
        sys.exit(__doc__)
    program, repository, out = map(pathlib.Path, words)
    quick = len(words) + 1 < len(sys.argv)
    product = Product(program, quick)
    work = out / "work"
    work.mkdir(parents=True, exist_ok=True)
    progress("objects")
    chosen = objects.find(work, os.environ.get("PEERD_CORPUS"), quick)
    progress("chapter 3")
    three = chapter3.sections(chosen, chapter3.measure(product, chosen)) + bouncing.sections(product, work, chosen)
    progress("chapter 4")
    four = chapter4.sections(product, work, repository)
    progress("appendix A")
    figures = appendix_a.sections(appendix_a.Scenario(appendix_a.simulate(product, work, repository)))
    text = page("The systems of the thesis, by name", introduction(chosen, quick),
                [("Chapter 3: collision detection", three), ("Chapter 4: distributed collision detection", four),
                 ("Appendix A: the test scenario", figures)], SLIPS)
    (out / "index.html").write_text(text)
    print(out / "index.html")


if __name__ == "__main__":
    main()
