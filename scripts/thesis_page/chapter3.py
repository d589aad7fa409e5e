"""Tables 3.1 to 3.3 and figures 3.1, 3.2 and 3.8: by `peerd volumes`."""
import printed
import svg
from page import Section, Table
from product import progress, shown

RULES = {"longest-side": "Longest Side", "splatter": "Splatter", "min-sum": "Min Sum"}
VOLUMES = ("18-DOP", "AABB", "OBB", "sphere")


def measure(product, objects):
    """What `peerd volumes` says of each object, its Shapes as one."""
    measured = {}
    for each in objects:
        progress(f"  {each.name}: volumes and hierarchies")
        options = ["--whole", "--curve", "--levels", "--steps", 40 if product.quick else 1000]
        for rule in RULES:
            options += ["--hierarchy", f"k=18,rule={rule},threshold=1"]
        measured[each.name] = product.json("volumes", each.path, *options)["shapes"][0]
    return measured


def percents(shape):
    p = shape["percent"]
    return p["18-dop"]["mean"], p["aabb"]["mean"], p["obb"], p["sphere"]


def mean(values):
    values = list(values)
    return sum(values) / len(values)


def same_model(ours, name):
    """Whether what has one value only, 18-DOP and AABB, is as printed."""
    return all(abs(a - b) <= 0.0051 for a, b in zip(ours[name][:2], printed.TIGHTNESS[name][:2]))


def signed(x):
    return f"{x:+.1f}".replace("-", "−")


def wins(rows):
    """How often each column is the least of its row."""
    return [sum(1 for row in rows if row.index(min(row)) == i) for i in range(len(VOLUMES))]


def tightness(objects, measured):
    section = Section("Table 3.1", "How much larger than its convex hull (100 %) is each object's 18-DOP, axis-aligned box, oriented "
                      "box and bounding sphere, on average over 7,000 rotations?")
    ours = {name: percents(measured[name]) for name in measured}
    rows = [[o.name, *(f"{x:.2f}" for x in ours[o.name]), *(f"{x:.2f}" for x in printed.TIGHTNESS[o.name]), o.origin] for o in objects]
    rows.append(["mean", *(f"{mean(r[i] for r in ours.values()):.2f}" for i in range(4)),
                 *(f"{mean(r[i] for r in printed.TIGHTNESS.values()):.2f}" for i in range(4)), ""])
    rows.append(["wins", *map(str, wins(list(ours.values()))), *map(str, wins(list(printed.TIGHTNESS.values()))), ""])
    section.tables.append(Table(["object", *VOLUMES, *(f"thesis: {v}" for v in VOLUMES), "our object"], rows))
    for o in objects:
        if o.origin == "generated":
            continue
        off = [100 * (a / b - 1) for a, b in zip(ours[o.name], printed.TIGHTNESS[o.name])]
        same = same_model(ours, o.name)
        words = ", ".join(f"{v} {signed(d)} %" for v, d in list(zip(VOLUMES, off))[2 if same else 0:])
        section.deviations.append(
            f"{o.name} is the thesis's own model: 18-DOP and AABB, in which nothing can be chosen, agree to the last printed digit. Its others "
            f"({words}) are fitted otherwise." if same else
            f"{o.name} is another model of the same kind than the thesis's. Against the print: {words}.")
    section.deviations.append("Generated objects have the thesis's names and resemble them in kind and size, no more: their numbers are "
                              "not to be compared one by one. The claims are: 18-DOPs and oriented boxes fit best, boxes along the axes "
                              "and spheres badly.")
    section.deviations.append("The thesis's oriented box is fitted by Eberly's algorithm and its sphere by a plug-in of 3ds max; ours are "
                              "a small box with a side in a face of the hull, turned as long as it shrinks, and the smallest ball. A "
                              "larger number in the print is their fit, not the object.")
    section.commands.append(shown("volumes", "OBJECT.wrl", "--whole", "--curve", "--json"))
    return section


def curves(objects, measured):
    section = Section("Figures 3.1 and 3.2", "The same volumes while the object turns around x, y, z, xy, xz, yz and xyz, a full turn "
                      "each: how much do they depend on the rotation?")
    for o in objects:
        turned, count = measured[o.name]["turned"], len(measured[o.name]["turned"])
        obb, sphere = measured[o.name]["percent"]["obb"], measured[o.name]["percent"]["sphere"]
        step = max(1, count // 700)
        x = [7 * i / count for i in range(0, count, step)]
        panel = svg.Panel([svg.Series("18-DOP", zip(x, (t[0] for t in turned[::step])), 0),
                           svg.Series("AABB", zip(x, (t[1] for t in turned[::step])), 1),
                           svg.Series("OBB", [(0, obb), (7, obb)], 2), svg.Series("sphere", [(0, sphere), (7, sphere)], 3)],
                          "full turns: x, y, z, xy, xz, yz, xyz", "% of the hull's volume", x_range=(0, 7))
        section.pictures.append(svg.chart(o.name, [panel]))
    least = min(measured[o.name]["percent"]["18-dop"]["least"] for o in objects)
    section.deviations.append(f"No 18-DOP is ever smaller than its hull (least: {least:.1f} %), as it must be.")
    return section


def by_rule(shape):
    return {h["rule"]: h for h in shape["hierarchies"]}


def heights(objects, measured):
    section = Section("Table 3.2", "How high do the three rules of splitting make the hierarchies of 18-DOPs, and how high need they be "
                      "(threshold 1)?")
    rows = []
    for o in objects:
        trees = by_rule(measured[o.name])
        rows.append([o.name, str(measured[o.name]["triangles"]), str(trees["splatter"]["least_height"]),
                     *(str(trees[r]["height"]) for r in RULES), *map(str, printed.HEIGHTS[o.name]), o.origin])
    section.tables.append(Table(["object", "triangles", "optimal", *RULES.values(), "thesis: optimal",
                                 *(f"thesis: {r}" for r in RULES.values()), "our object"], rows))
    from_corpus = [o.name for o in objects if o.origin != "generated"]
    same = [n for n in from_corpus if by_rule(measured[n])["splatter"]["least_height"] == printed.HEIGHTS[n][0]]
    if from_corpus:
        section.deviations.append(f"Of the corpus's objects {', '.join(same) or 'none'} have the print's optimal height if triangles are counted, "
                                  "as here: it is one less of their polygons. So the thesis's objects were triangles, too.")
    worst = max(objects, key=lambda o: max(h["height"] - h["least_height"] for h in measured[o.name]["hierarchies"]))
    trees = by_rule(measured[worst.name])
    section.deviations.append(f"Farthest from the optimum is {worst.name} with {max(h['height'] for h in trees.values())} levels for "
                              f"{trees['splatter']['least_height']} (the thesis: Truck with 99, 34 and 56 for 16). It is the "
                              "distribution of polygons that makes such trees: our Truck has springs whose triangles shrink by a "
                              "fixed ratio.")
    section.deviations.append("Both split at the mean of vertices (equation 3.1): ours counts a vertex once for each triangle that uses it, the thesis does "
                              "not say. Nodes of triangles with one centroid are halved here. Trees of the very same object differ by so much.")
    section.commands.append(shown("volumes", "OBJECT.wrl", "--whole", "--hierarchy", "k=18,rule=splatter,threshold=1"))
    return section


def build_times(objects, measured):
    section = Section("Table 3.3", "How long does it take to build them?")
    rows, ratios = [], []
    for o in objects:
        trees = by_rule(measured[o.name])
        seconds = [trees[r]["build_s"] for r in RULES]
        ratios.append(seconds[2] / min(seconds[:2]))
        rows.append([o.name, *(f"{s:.4f}" for s in seconds), f"{ratios[-1]:.0f}", *(f"{s:.2f}" for s in printed.BUILD_S[o.name]),
                     f"{printed.BUILD_S[o.name][2] / min(printed.BUILD_S[o.name][:2]):.1f}"])
    section.tables.append(Table(["object", *(f"{r} [s]" for r in RULES.values()), "Min Sum to the faster", *(f"thesis: {r} [s]" for r in RULES.values()),
                                 "thesis: Min Sum to the faster"], rows))
    printed_ratio = mean(b[2] / min(b[:2]) for b in printed.BUILD_S.values())
    faster = [mean(printed.BUILD_S[n][i] / by_rule(measured[n])[r]["build_s"] for n in printed.BUILD_S) for i, r in enumerate(RULES)]
    section.deviations.append(f"Min Sum takes {mean(ratios):.0f} times as long as the faster of the others here and {printed_ratio:.1f} times in the print. "
                              f"Against the print Longest Side is {faster[0]:,.0f} times as fast, Splatter {faster[1]:,.0f} times, Min Sum {faster[2]:,.0f} times: "
                              "the thesis cuts a boundary of 18 planes for each node by any rule; here only Min Sum does, for the volumes that it compares.")
    section.deviations.append("Seconds are of one run on a shared computer of today against two Xeons of 2 GHz in 2003; only ratios can be "
                              "compared.")
    return section


def levels(objects, measured):
    section = Section("Figure 3.8", "How fast do the volumes of a hierarchy's levels shrink, by rule? (All nodes of a level, with the leaves "
                      "above it.)")
    first, crowded = [], []
    for o in objects:
        trees = by_rule(measured[o.name])
        series = [svg.Series(RULES[r], enumerate(trees[r]["level_percent"][:26]), i) for i, r in enumerate(RULES)]
        section.pictures.append(svg.chart(o.name, [svg.Panel(series, "level", "% of the root's volume", log_y=True)]))
        at = [trees[r]["level_percent"][min(5, len(trees[r]["level_percent"]) - 1)] for r in RULES]
        first.append(at.index(min(at)))
        if any(b > a for a, b in zip(trees["splatter"]["level_percent"], trees["splatter"]["level_percent"][1:])):
            crowded.append(o.name)
    names = list(RULES.values())
    section.deviations.append("Of " + str(len(objects)) + " objects the least volume at level 5 is by rule: " + ", ".join(f"{names[i]} {first.count(i)}" for i in range(3)) +
                              ". The thesis: Min Sum converges fastest, and Splatter faster than Longest Side in most cases.")
    section.deviations.append("A level with more volume than the one above (its nodes overlap), which the thesis sees in Piping, is seen with Splatter in " +
                              (", ".join(crowded) or "none") + ". Pictures end at level 25, as the thesis's of Truck does.")
    return section


def sections(objects, measured):
    return [make(objects, measured) for make in (tightness, curves, heights, build_times, levels)]
