#include "peerd/config/motion_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include <muParser.h>

#include "peerd/config/right_derivatives.hpp"

namespace peerd::config {

// muParser keeps addresses of the variables, so this stays where it was made.
struct MotionSource::Formulas {
  double t = 0.0;
  std::vector<double> defined;           // sized before any address is taken
  std::vector<mu::Parser> definitions;   // evaluated in order after each change of t
  std::array<mu::Parser, 4> components;  // x, y, z, angle
  Vec3 axis = Vec3::UnitY();
  bool hold_before_start = false;
  bool rotates = false;

  double evaluate(mu::Parser& parser, double at) {
    t = at;
    for (std::size_t i = 0; i < definitions.size(); ++i) defined[i] = definitions[i].Eval();
    return parser.Eval();
  }
};

namespace {

// "name = expression"; an empty name when it is not that.
std::pair<std::string, std::string> split_definition(const std::string& definition) {
  const std::size_t equals = definition.find('=');
  if (equals == std::string::npos) return {};
  const std::string_view left = std::string_view(definition).substr(0, equals);
  const std::size_t begin = left.find_first_not_of(' '), end = left.find_last_not_of(' ');
  if (begin == std::string_view::npos) return {};
  const std::string_view name = left.substr(begin, end - begin + 1);
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto in_name = [&](char c) { return letter(c) || (c >= '0' && c <= '9'); };
  if (!letter(name.front()) || !std::ranges::all_of(name, in_name)) return {};
  return {std::string(name), definition.substr(equals + 1)};
}

}  // namespace

MotionSource::MotionSource(std::unique_ptr<Formulas> formulas) : formulas_(std::move(formulas)) {}
MotionSource::MotionSource(MotionSource&&) noexcept = default;
MotionSource& MotionSource::operator=(MotionSource&&) noexcept = default;
MotionSource::~MotionSource() = default;

MotionFormula read_motion_formula(TomlReader& reader) {
  MotionFormula m;
  reader.read("define", m.define);
  reader.read("x", m.x);
  reader.read("y", m.y);
  reader.read("z", m.z);
  reader.read("axis", m.axis, 3);
  reader.read("angle", m.angle);
  std::size_t before_start = 0;
  reader.read_word("before_start", before_start, {"run", "hold"});
  m.hold_before_start = before_start == 1;
  if (Vec3(m.axis[0], m.axis[1], m.axis[2]).isZero(0.0)) {
    reader.fail(reader.raw().get("axis"), reader.dotted("axis") + " must not be zero");
  }
  reader.finish();
  return m;
}

Result<MotionSource> MotionSource::make(const MotionFormula& formula, const std::string& what, double duration_s) {
  auto f = std::make_unique<Formulas>();
  f->axis = Vec3(formula.axis[0], formula.axis[1], formula.axis[2]).normalized();
  f->hold_before_start = formula.hold_before_start;
  f->rotates = formula.angle != "0";
  f->defined.resize(formula.define.size());
  f->definitions.reserve(formula.define.size());
  std::string doing;
  try {
    std::vector<std::string> names;
    const auto set_up = [&](mu::Parser& parser, const std::string& expression) {
      doing = expression;
      parser.DefineConst("pi", std::numbers::pi);
      parser.DefineFun(
          "floor", +[](double x) { return std::floor(x); });
      parser.DefineFun(
          "mod", +[](double x, double y) { return x - y * std::floor(x / y); });
      parser.DefineVar("t", &f->t);
      for (std::size_t i = 0; i < names.size(); ++i) parser.DefineVar(names[i], &f->defined[i]);
      parser.SetExpr(expression);
      (void)parser.Eval();
    };
    for (const std::string& definition : formula.define) {
      const auto [name, expression] = split_definition(definition);
      if (name.empty()) {
        return std::unexpected(InputError{"error: " + what + ".define: write \"" + definition +
                                          "\" as \"name = expression\", the name in letters, digits and _"});
      }
      set_up(f->definitions.emplace_back(), expression);
      names.push_back(name);
    }
    const std::array<const std::string*, 4> texts{&formula.x, &formula.y, &formula.z, &formula.angle};
    for (std::size_t i = 0; i < texts.size(); ++i) set_up(f->components[i], *texts[i]);
  } catch (const mu::Parser::exception_type& e) {
    return std::unexpected(InputError{"error: " + what + ": formula \"" + doing + "\": " + e.GetMsg()});
  }
  MotionSource source(std::move(f));
  for (const double t : {-2.0, -1.0, 0.0, 0.5 * duration_s, duration_s}) {
    const KinematicState s = source.sample(t);
    if (s.position.allFinite() && s.velocity.allFinite() && s.acceleration.allFinite() &&
        s.orientation.coeffs().allFinite()) {
      continue;
    }
    return std::unexpected(InputError{"error: " + what + ": the formula is not finite at t = " + std::to_string(t) +
                                      (t < 0 ? "; before_start = \"hold\" keeps the object still until t = 0" : "")});
  }
  return source;
}

Pose MotionSource::pose(double t_s) const {
  Formulas& f = *formulas_;
  const double t = f.hold_before_start ? std::max(0.0, t_s) : t_s;
  Pose pose;
  for (int i = 0; i < 3; ++i) pose.position[i] = f.evaluate(f.components[static_cast<std::size_t>(i)], t);
  if (f.rotates) pose.orientation = Quat(Eigen::AngleAxisd(f.evaluate(f.components[3], t), f.axis));
  return pose;
}

KinematicState MotionSource::sample(double t_s) const {
  Formulas& f = *formulas_;
  if (f.hold_before_start && t_s < 0.0) return at_rest(pose(0.0));
  KinematicState s;
  for (int i = 0; i < 3; ++i) {
    const auto d =
        right_derivatives([&](double t) { return f.evaluate(f.components[static_cast<std::size_t>(i)], t); }, t_s);
    s.position[i] = d.value;
    s.velocity[i] = d.first;
    s.acceleration[i] = d.second;
  }
  if (f.rotates) {
    const auto d = right_derivatives([&](double t) { return f.evaluate(f.components[3], t); }, t_s);
    s.orientation = Quat(Eigen::AngleAxisd(d.value, f.axis));
    s.angular_velocity_body = d.first * f.axis;  // a turn about a fixed axis leaves that axis where it is in the body
  }
  return s;
}

}  // namespace peerd::config
