#include "peerd/measure/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <string_view>
#include <vector>

#include "peerd/measure/agreement.hpp"
#include "peerd/measure/lookup.hpp"

namespace peerd::report {
namespace {

// Appends cells to one growing text. A report is tens of megabytes with a budget of time, so there are no streams.
class CsvText {
 public:
  explicit CsvText(std::string_view heading) : text_(heading) { text_ += '\n'; }
  void reserve(std::size_t bytes) { text_.reserve(bytes); }

  template <class Number>
  requires std::integral<Number> || std::floating_point<Number> CsvText& number(Number value) {
    std::array<char, 32> digits;  // the longest binary64, -2.2250738585072014e-308, takes 24
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    text_.append(digits.data(), end);
    text_ += ',';
    return *this;
  }
  CsvText& vector(const Vec3& v) { return number(v.x()).number(v.y()).number(v.z()); }
  CsvText& raw(std::string_view cell) {
    text_ += cell;
    text_ += ',';
    return *this;
  }
  void end_row() { text_.back() = '\n'; }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

std::string peer_cell(const RunRecord& run, PeerId peer) { return quoted(peer_name(run, peer)); }
std::string object_cell(const RunRecord& run, ObjectId object) { return quoted(object_path(run, object)); }

// Indices of rows in order of time, rows of one instant in their given order.
template <class Row>
std::vector<std::size_t> by_time(const std::vector<Row>& rows) {
  std::vector<std::size_t> order(rows.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return rows[i].t_s; });
  return order;
}

}  // namespace

std::string errors_csv(std::span<const RunRecord> runs) {
  CsvText csv(
      "run,t_s,observer,object,truth_x,truth_y,truth_z,ghost_x,ghost_y,ghost_z,shown_x,shown_y,shown_z,"
      "ghost_error_m,shown_error_m,ghost_angle_error_rad");
  std::size_t rows = 0;
  for (const RunRecord& run : runs) rows += run.ghost_samples.size();
  csv.reserve(rows * 240 + 256);  // a moving object's row is about this long

  for (std::size_t r = 0; r < runs.size(); ++r) {
    const RunRecord& run = runs[r];
    PeerId observer;
    ObjectId object;
    std::string names;  // names of the current series
    for (const GhostSample& s : run.ghost_samples) {
      if (names.empty() || s.observer != observer || s.object != object) {
        observer = s.observer;
        object = s.object;
        names = peer_cell(run, observer) + ',' + object_cell(run, object);
      }
      csv.number(r + 1).number(s.t_s).raw(names);
      csv.vector(s.truth.position).vector(s.ghost.position).vector(s.shown.position);
      csv.number(ghost_error_m(s)).number(shown_error_m(s));
      csv.number(angle_between(s.truth.orientation, s.ghost.orientation)).end_row();
    }
  }
  return csv.take();
}

std::string traffic_csv(std::span<const RunRecord> runs) {
  CsvText csv("run,t_s,sender,kind,object,bytes,threshold_m,reason");
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const RunRecord& run = runs[r];
    const auto add_update = [&](const UpdateSent& u) {
      csv.number(r + 1).number(u.t_s).raw(peer_cell(run, u.sender)).raw("update").raw(object_cell(run, u.object));
      csv.number(u.bytes).number(u.threshold_m).raw(quoted(u.reason)).end_row();
    };
    const auto add_datagram = [&](const DatagramSent& d) {
      csv.number(r + 1).number(d.t_s).raw(peer_cell(run, d.sender)).raw("datagram").raw("");
      csv.number(d.bytes).raw("").raw("").end_row();
    };
    const std::vector<std::size_t> updates = by_time(run.updates);
    auto update = updates.begin();
    for (const std::size_t d : by_time(run.datagrams)) {
      while (update != updates.end() && run.updates[*update].t_s <= run.datagrams[d].t_s)
        add_update(run.updates[*update++]);
      add_datagram(run.datagrams[d]);
    }
    while (update != updates.end()) add_update(run.updates[*update++]);
  }
  return csv.take();
}

std::string collisions_csv(std::span<const RunRecord> runs) {
  CsvText csv("run,t_s,peer,kind,collider,collidee,normal_x,normal_y,normal_z,reported_at_s,verdict");
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const RunRecord& run = runs[r];
    const Agreement judged = agreement(run);
    for (const std::size_t i : by_time(run.contacts)) {
      const ContactRow& c = run.contacts[i];
      csv.number(r + 1).number(c.t_s).raw(peer_cell(run, c.peer)).raw(quoted(c.kind));
      csv.raw(object_cell(run, c.collider)).raw(object_cell(run, c.collidee)).vector(c.normal);
      csv.number(c.reported_at_s).raw(to_string(judged.verdicts[i])).end_row();
    }
  }
  return csv.take();
}

}  // namespace peerd::report
