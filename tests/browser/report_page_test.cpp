// report.html of a small sweep in a headless Chromium, the test of report.js: every figure is drawn and has its axes, a
// legend and values under the pointer; nothing on the console, nothing wider than the window, no text outside of its
// picture or on another.

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/net/process.hpp"

namespace peerd::testing_support::report_page_test {

namespace fs = std::filesystem;

constexpr double kPatience_s = 100.0;  // a browser starts within seconds; a busy machine takes its time

fs::path find_browser() {
  const char* path = std::getenv("PATH");
  std::string folders = path != nullptr ? path : "";
  for (std::size_t begin = 0; begin < folders.size();) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    const fs::path program = fs::path(folders.substr(begin, end - begin)) / "chromium";
    if (fs::exists(program)) return program;
    begin = end + 1;
  }
  return {};
}

// The script finds what a reader would call broken, by the browser's own layout, and leaves it in the page's last
// element. All is unfolded first, which draws the figures of the runs. A text's box is a little higher than its
// letters, so texts may touch, but not by more than a third of their height.
constexpr const char* kFindFaults = R"js(
<script>
window.addEventListener('load', () => {
  for (const d of document.querySelectorAll('details')) {
    d.open = true;
    d.dispatchEvent(new Event('toggle'));
  }
  const faults = [];
  const page = document.documentElement;
  if (page.scrollWidth > page.clientWidth) faults.push('page is ' + page.scrollWidth + ' wide');
  for (const e of document.body.querySelectorAll('*')) {
    if (e.closest('svg') || e.closest('.scroll')) continue;
    const box = e.getBoundingClientRect();
    if (box.right > page.clientWidth + 1) faults.push(e.tagName + ' reaches ' + box.right);
  }
  let texts = 0, figures = 0, values = 0;
  for (const figure of document.querySelectorAll('figure')) {
    ++figures;
    const name = figure.dataset.name, svg = figure.querySelector('svg');
    if (!svg || svg.querySelectorAll('.axes').length === 0 || !figure.querySelector('button')) {
      faults.push(name + ' is not drawn');
      continue;
    }
    // A saved picture has plain colours.
    let saved = null;
    URL.createObjectURL = blob => { saved = blob; return 'data:,'; };
    HTMLAnchorElement.prototype.click = () => {};
    figure.querySelector('button').click();
    if (!saved || saved.size < 1000) faults.push(name + ' is not saved');
    // The pointer in the middle of a panel shows values, and an entry of the legend switches its series.
    for (const area of svg.querySelectorAll('.area, .bar')) {
      const box = area.getBoundingClientRect();
      area.dispatchEvent(new PointerEvent('pointermove', {clientX: box.left + box.width / 2, clientY: box.top + box.height / 2}));
      if (!document.querySelector('.tip').hidden) ++values;
      area.dispatchEvent(new PointerEvent('pointerleave'));
    }
    for (const entry of svg.querySelectorAll('.entry')) {
      const hidden = () => svg.querySelectorAll('[display=none]').length;
      entry.dispatchEvent(new MouseEvent('click'));
      if (hidden() === 0) faults.push(name + ': the legend does not switch ' + entry.textContent);
      entry.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter'}));
      if (hidden() > 0) faults.push(name + ': the legend does not switch back ' + entry.textContent);
    }
  }
  for (const svg of document.querySelectorAll('svg')) {
    const frame = svg.getBoundingClientRect();
    const boxes = [...svg.querySelectorAll('text')].map(t => ({words: t.textContent, box: t.getBoundingClientRect()}));
    texts += boxes.length;
    const title = boxes.length > 0 ? boxes[0].words : '';
    boxes.forEach(({words, box}, i) => {
      if (box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 ||
          box.bottom > frame.bottom + 1) faults.push(title + ': outside: ' + words);
      for (const other of boxes.slice(i + 1)) {
        const across = Math.min(box.right, other.box.right) - Math.max(box.left, other.box.left);
        const down = Math.min(box.bottom, other.box.bottom) - Math.max(box.top, other.box.top);
        if (across > 1 && down > Math.min(box.height, other.box.height) / 3)
          faults.push(title + ': ' + words + ' on ' + other.words);
      }
    });
  }
  const found = document.createElement('pre');
  found.id = 'found';
  found.textContent = [`width: ${window.innerWidth}`, `figures: ${figures}`, `values: ${values}`, `texts: ${texts}`,
                       ...faults.map(f => 'fault: ' + f)].join('\n');
  document.body.append(found);
});
</script>
)js";

class ReportPage : public testing::Test {
 protected:
  void SetUp() override {
    browser_ = find_browser();
    if (browser_.empty()) GTEST_SKIP() << "no program chromium; scripts/test --full installs it";
    Process sim(folder_, "sim", PEERD_PROGRAM,
                {"sim", PEERD_SOURCE_DIR "/configs/scenarios/eq47.toml", "--out", (folder_ / "out").string(), "--set",
                 "duration_s=9", "--set", "sample_hz=20", "--set", "network.latency_ms=[5,100]"});
    ASSERT_EQ(sim.exit_code(kPatience_s), 0) << sim.err();
  }

  // The faults that kFindFaults finds in the page with `added` at its end. A window is not narrower than 500 px; a
  // frame is.
  [[nodiscard]] std::string faults_with(const std::string& added, int width) {
    std::string html = text_of(folder_ / "out" / "report.html");
    const std::size_t end = html.rfind("</body>");
    EXPECT_NE(end, std::string::npos);
    html.insert(std::min(end, html.size()), added + kFindFaults);
    folder_.write("out/checked.html", html);
    const fs::path frame = folder_.write(
        "out/frame.html",
        "<!DOCTYPE html><iframe src='checked.html' style='border: 0; height: 900px; width: " + std::to_string(width) +
            "px'></iframe><pre></pre><script>window.addEventListener('load', () => {"
            "document.querySelector('pre').textContent = document.querySelector('iframe')"
            ".contentDocument.getElementById('found').textContent; });</script>");
    std::vector<std::string> arguments{"--headless=new",
                                       "--disable-gpu",
                                       "--no-first-run",
                                       "--hide-scrollbars",
                                       "--disable-dev-shm-usage",
                                       "--allow-file-access-from-files",
                                       "--user-data-dir=" + (folder_ / "profile").string(),
                                       "--window-size=1600,1000",
                                       "--enable-logging=stderr",
                                       "--v=0",
                                       "--dump-dom",
                                       "file://" + frame.string()};
    if (geteuid() == 0) arguments.insert(arguments.begin(), "--no-sandbox");  // which it cannot set up for root
    Process browser(folder_, "browser", browser_.string(), arguments);
    EXPECT_EQ(browser.exit_code(kPatience_s), 0) << browser.err();
    console_ = browser.err();
    const std::string dom = browser.out();
    const std::size_t begin = dom.find("<pre>");
    EXPECT_NE(begin, std::string::npos) << dom;
    return begin == std::string::npos ? "" : dom.substr(begin, dom.find("</pre>") - begin);
  }

  ScratchFolder folder_;
  fs::path browser_;
  std::string console_;
};

// An error on the console is seen, and so is what sticks out.
TEST_F(ReportPage, CheckSeesFaults) {
  const std::string found = faults_with(
      "<script>throw new Error('on purpose')</script><div style='width: 3000px'>wide</div>"
      "<figure data-name='empty'></figure>"
      "<svg width='100' height='50'><text x='90' y='20'>sticks out</text><text x='90' y='20'>on it</text></svg>",
      1400);
  EXPECT_THAT(console_, testing::HasSubstr("CONSOLE"));
  EXPECT_THAT(found, testing::HasSubstr("fault: page is 30"));
  EXPECT_THAT(found, testing::HasSubstr("fault: DIV reaches 30"));
  EXPECT_THAT(found, testing::HasSubstr("fault: empty is not drawn"));
  EXPECT_THAT(found, testing::HasSubstr("fault: sticks out: outside: sticks out"));
  EXPECT_THAT(found, testing::HasSubstr("fault: sticks out: sticks out on on it"));
}

class ReportPageOfWidth : public ReportPage, public testing::WithParamInterface<int> {};
TEST_P(ReportPageOfWidth, IsWithoutFaults) {
  const std::string found = faults_with("", GetParam());
  EXPECT_THAT(console_, testing::Not(testing::HasSubstr("CONSOLE")));
  EXPECT_THAT(found, testing::Not(testing::HasSubstr("fault: ")));
  EXPECT_THAT(found, testing::HasSubstr("width: " + std::to_string(GetParam()) + '\n'));
  const std::size_t texts = found.find("texts: ");
  ASSERT_NE(texts, std::string::npos) << console_;
  EXPECT_GT(std::stoi(found.substr(texts + 7)), 1000);  // it has looked at the pictures
  const auto number = [&](const std::string& what) { return std::stoi(found.substr(found.find(what) + what.size())); };
  EXPECT_EQ(number("figures: "), 4 + 2 * 12);
  EXPECT_GT(number("values: "), 80);
}
INSTANTIATE_TEST_SUITE_P(Widths, ReportPageOfWidth, testing::Values(400, 1400),
                         [](const auto& tested) { return "Of" + std::to_string(tested.param); });

}  // namespace peerd::testing_support::report_page_test
