#include "peerd/peer/node/peer_log.hpp"

#include <charconv>
#include <fstream>
#include <sstream>

#include "peerd/input/text_file.hpp"

namespace peerd {
namespace {

// Writes one row to a line: its kind first, then its fields, separated by spaces; numbers in their shortest exact form.
class RowWriter {
 public:
  RowWriter& row(char kind) {
    text_ += text_.empty() ? "" : "\n";
    text_ += kind;
    return *this;
  }
  RowWriter& operator<<(const std::string& word) {
    text_ += ' ';
    text_ += word.empty() ? "-" : word;
    return *this;
  }
  template <class Number>
  requires std::is_arithmetic_v<Number> RowWriter& operator<<(Number x) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, x);
    text_ += ' ';
    text_.append(digits, end.ptr);
    return *this;
  }
  RowWriter& operator<<(SimTime t) { return *this << t.time_since_epoch().count(); }
  RowWriter& operator<<(HostTime t) { return *this << t.time_since_epoch().count(); }
  RowWriter& operator<<(Duration d) { return *this << d.count(); }
  RowWriter& operator<<(ObjectId id) { return *this << id.packed(); }
  RowWriter& operator<<(PeerId id) { return *this << id.value; }
  RowWriter& operator<<(const Vec3& v) { return *this << v.x() << v.y() << v.z(); }
  RowWriter& operator<<(const Pose& p) {
    const Quat& q = p.orientation;
    return *this << p.position << q.w() << q.x() << q.y() << q.z();
  }
  RowWriter& operator<<(const KinematicState& s) {
    return *this << s.position << s.velocity << s.acceleration << s.orientation.w() << s.orientation.x()
                 << s.orientation.y() << s.orientation.z() << s.angular_velocity_body;
  }
  RowWriter& operator<<(CollisionType type) { return *this << std::string(name_of(type)); }
  RowWriter& operator<<(const TouchedPolygons& polygons) {
    *this << polygons.count << polygons.pairs.size();
    for (const auto& [a, b] : polygons.pairs) *this << a.shape << a.polygon << b.shape << b.polygon;
    return *this;
  }
  [[nodiscard]] std::string take() { return std::move(text_) + "\n"; }

 private:
  std::string text_;
};

// Reads one row. A field that is missing or malformed makes the row bad for good.
class RowReader {
 public:
  explicit RowReader(const std::string& line) : in_(line) {}
  RowReader& operator>>(std::string& word) {
    if (!(in_ >> word)) good_ = false;
    return *this;
  }
  template <class Number>
  requires std::is_arithmetic_v<Number> RowReader& operator>>(Number& x) {
    std::string word;
    *this >> word;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    good_ = good_ && error == std::errc{} && end == word.data() + word.size();
    return *this;
  }
  template <class Tag>
  RowReader& operator>>(std::chrono::time_point<InjectedClock<Tag>>& t) {
    std::int64_t ns = 0;
    *this >> ns;
    t = std::chrono::time_point<InjectedClock<Tag>>{Duration{ns}};
    return *this;
  }
  RowReader& operator>>(Duration& d) {
    std::int64_t ns = 0;
    *this >> ns;
    d = Duration{ns};
    return *this;
  }
  RowReader& operator>>(ObjectId& id) {
    std::uint64_t packed = 0;
    *this >> packed;
    id = ObjectId::unpacked(packed);
    return *this;
  }
  template <class Tag, class Rep>
  RowReader& operator>>(Strong<Tag, Rep>& id) {
    return *this >> id.value;
  }
  RowReader& operator>>(Vec3& v) { return *this >> v.x() >> v.y() >> v.z(); }
  RowReader& operator>>(Pose& p) {
    Quat& q = p.orientation;
    return *this >> p.position >> q.w() >> q.x() >> q.y() >> q.z();
  }
  RowReader& operator>>(KinematicState& s) {
    return *this >> s.position >> s.velocity >> s.acceleration >> s.orientation.w() >> s.orientation.x() >>
           s.orientation.y() >> s.orientation.z() >> s.angular_velocity_body;
  }
  RowReader& operator>>(CollisionType& type) {
    std::string word;
    *this >> word;
    for (const auto each : {CollisionType::kBox, CollisionType::kWitness, CollisionType::kAllPairs}) {
      if (word == name_of(each)) {
        type = each;
        return *this;
      }
    }
    good_ = false;
    return *this;
  }
  RowReader& operator>>(TouchedPolygons& polygons) {
    std::size_t kept = 0;
    *this >> polygons.count >> kept;
    good_ = good_ && kept <= TouchedPolygons::kKept;
    for (std::size_t i = 0; good_ && i < kept; ++i) {
      auto& [a, b] = polygons.pairs.emplace_back();
      *this >> a.shape >> a.polygon >> b.shape >> b.polygon;
    }
    return *this;
  }
  [[nodiscard]] bool good() const { return good_; }

 private:
  std::istringstream in_;
  bool good_ = true;
};

bool read_row(const std::string& line, PeerLog& log) {
  RowReader in(line.substr(1));
  switch (line.front()) {
    case 'P':
      in >> log.peer >> log.name >> log.groups_joined >> log.other_worlds;
      break;
    case 'S':
      in >> log.start.emplace();
      break;
    case 'E':
      in >> log.ended_at.emplace();
      break;
    case 'L': {
      auto& l = log.bound.emplace();
      in >> l.least >> l.most >> l.latest_by;
      break;
    }
    case 'B': {
      auto& b = log.object_samples.emplace_back();
      in >> b.at >> b.true_at >> b.object >> b.owner >> b.state >> b.shown;
      break;
    }
    case 'U': {
      auto& u = log.updates.emplace_back();
      in >> u.at >> u.object >> u.bytes >> u.threshold_m >> u.reason;
      break;
    }
    case 'D': {
      auto& d = log.datagrams.emplace_back();
      in >> d.at >> d.bytes;
      break;
    }
    case 'C': {
      auto& c = log.contacts.emplace_back();
      in >> c.at >> c.kind >> c.collider >> c.collidee >> c.normal >> c.known_at >> c.type >> c.polygons;
      break;
    }
    case 'A': {
      ObjectId object;
      std::string path;
      in >> object >> path;
      log.paths[object] = path;
      break;
    }
    case 'N': {
      std::string name;
      std::uint64_t count = 0;
      in >> name >> count;
      log.counters[name] = count;
      break;
    }
    default:
      return false;
  }
  return in.good();
}

}  // namespace

Result<void> save(const PeerLog& log, const std::filesystem::path& path) {
  RowWriter out;
  out.row('P') << log.peer << log.name << log.groups_joined << log.other_worlds;
  if (log.start) out.row('S') << *log.start;
  if (log.ended_at) out.row('E') << *log.ended_at;
  if (log.bound) out.row('L') << log.bound->least << log.bound->most << log.bound->latest_by;
  for (const auto& b : log.object_samples) {
    out.row('B') << b.at << b.true_at << b.object << b.owner << b.state << b.shown;
  }
  for (const auto& u : log.updates) out.row('U') << u.at << u.object << u.bytes << u.threshold_m << u.reason;
  for (const auto& d : log.datagrams) out.row('D') << d.at << d.bytes;
  for (const auto& c : log.contacts) {
    out.row('C') << c.at << c.kind << c.collider << c.collidee << c.normal << c.known_at << c.type << c.polygons;
  }
  for (const auto& [object, added] : log.paths) out.row('A') << object << added;
  for (const auto& [name, count] : log.counters) out.row('N') << name << count;
  return write_text_file(path, out.take());
}

Result<PeerLog> load_peer_log(const std::filesystem::path& path) {
  const auto text = read_text_file(path, kPeerLogFile);
  if (!text) return std::unexpected(text.error());
  PeerLog log;
  std::istringstream lines(*text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.empty() || read_row(line, log)) continue;
    return std::unexpected(InputError{
        path.string() + ":" + std::to_string(number) + ":1: error: not a row of a peer's log", kSystemFailed});
  }
  return log;
}

}  // namespace peerd
