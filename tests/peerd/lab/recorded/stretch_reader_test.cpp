#include "peerd/lab/recorded/stretch_reader.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "peerd/input/compression.hpp"
#include "peerd/lab/recorded/stretch_writer.hpp"
#include "tests/must.hpp"

namespace peerd::recorded::stretch_reader_test {

TEST(StretchReader, GivesEachFrameWithTheRowsThatHaveChanged) {
  StretchWriter writer;
  view::PoseRow row;
  for (int i = 0; i < 3; ++i) {
    row.position[0] = i < 2 ? 1.0 : 2.0;
    writer.add(0.5 * i, 1, 1, {}, std::vector{row});
  }
  const auto stretch = only(writer.finish());
  std::vector<double> times;
  std::vector<std::size_t> rows;
  read_frames(stretch, [&](double t_s, std::span<const view::PoseRow> changed) {
    times.push_back(t_s);
    rows.push_back(changed.size());
  });
  EXPECT_EQ(times, (std::vector{0.0, 0.5, 1.0}));
  EXPECT_EQ(rows, (std::vector<std::size_t>{1, 0, 1}));
}

TEST(StretchReader, RefusesWhatIsNotWhole) {
  const Stretch damaged{.frames = compress("frames").substr(1), .size_bytes = 6};
  EXPECT_THROW(read_frames(damaged, [](double, std::span<const view::PoseRow>) {}), std::logic_error);
}

}  // namespace peerd::recorded::stretch_reader_test
