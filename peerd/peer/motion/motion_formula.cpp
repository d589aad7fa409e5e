#include "peerd/peer/motion/motion_formula.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include <muParser.h>

#include "peerd/input/number.hpp"
#include "peerd/peer/motion/right_derivatives.hpp"

namespace peerd::motion {

// muParser keeps the addresses of variables, so this object must not move.
struct FormulaMotion::Formulas {
  double t = 0.0, n = 0.0;
  std::vector<double> defined;           // sized before any address is taken
  std::vector<mu::Parser> definitions;   // evaluated in order after each change of t
  std::array<mu::Parser, 5> components;  // x, y, z, angle, spin angle
  Vec3 axis, offset, spin_axis;
  bool hold_before_start = false;
  bool turns = false, spins = false;

  double evaluate(mu::Parser& parser, double at) {
    t = at;
    for (std::size_t i = 0; i < definitions.size(); ++i) defined[i] = definitions[i].Eval();
    return parser.Eval();
  }
  double value(std::size_t component, double at) { return evaluate(components[component], at); }
  RightDerivatives derivatives(std::size_t component, double at) {
    return right_derivatives([&](double later) { return value(component, later); }, at);
  }
};

namespace {

constexpr std::size_t kAngle = 3, kSpinAngle = 4;  // components

Vec3 to_vec3(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

// Splits "name = expression". The name is empty where the text has another form.
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

FormulaMotion::FormulaMotion(std::unique_ptr<Formulas> formulas) : formulas_(std::move(formulas)) {}
FormulaMotion::FormulaMotion(FormulaMotion&&) noexcept = default;
FormulaMotion& FormulaMotion::operator=(FormulaMotion&&) noexcept = default;
FormulaMotion::~FormulaMotion() = default;

MotionFormula read_motion_formula(TomlReader& reader) {
  MotionFormula m;
  reader.read("define", m.define);
  reader.read("x", m.x);
  reader.read("y", m.y);
  reader.read("z", m.z);
  reader.read("axis", m.axis, 3);
  reader.read("angle", m.angle);
  reader.read("offset", m.offset, 3);
  reader.read("spin_axis", m.spin_axis, 3);
  reader.read("spin_angle", m.spin_angle);
  for (const auto& [key, axis] : {std::pair{"axis", &m.axis}, {"spin_axis", &m.spin_axis}}) {
    if (!(to_vec3(*axis).norm() >= kDirectionMin))
      reader.fail(reader.raw().get(key), reader.dotted(key) + " must not be zero, or as good as zero");
  }
  return m;
}

Result<FormulaMotion> FormulaMotion::make(const MotionFormula& formula, const std::string& what, double duration_s,
                                          std::size_t number) {
  auto f = std::make_unique<Formulas>();
  f->n = static_cast<double>(number);
  f->axis = to_vec3(formula.axis).normalized();
  f->offset = to_vec3(formula.offset);
  f->spin_axis = to_vec3(formula.spin_axis).normalized();
  f->hold_before_start = formula.hold_before_start;
  f->turns = formula.angle != "0";
  f->spins = formula.spin_angle != "0";
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
      parser.DefineVar("n", &f->n);
      for (std::size_t i = 0; i < names.size(); ++i) parser.DefineVar(names[i], &f->defined[i]);
      parser.SetExpr(expression);
      (void)parser.Eval();
    };
    for (const std::string& definition : formula.define) {
      const auto [name, expression] = split_definition(definition);
      if (name.empty()) {
        return std::unexpected(InputError{what + ".define: write \"" + definition +
                                          "\" as \"name = expression\", the name in letters, digits and _"});
      }
      set_up(f->definitions.emplace_back(), expression);
      names.push_back(name);
    }
    const std::array<const std::string*, 5> texts{&formula.x, &formula.y, &formula.z, &formula.angle,
                                                  &formula.spin_angle};
    for (std::size_t i = 0; i < texts.size(); ++i) set_up(f->components[i], *texts[i]);
  } catch (const mu::Parser::exception_type& e) {
    return std::unexpected(InputError{what + ": formula \"" + doing + "\": " + e.GetMsg()});
  }
  FormulaMotion source(std::move(f));
  for (const double t : {-2.0, -1.0, 0.0, 0.5 * duration_s, duration_s}) {
    const KinematicState s = source.sample(t);
    if (s.position.allFinite() && s.velocity.allFinite() && s.acceleration.allFinite() &&
        s.orientation.coeffs().allFinite()) {
      continue;
    }
    return std::unexpected(InputError{what + ": the formula is not finite at t = " + std::to_string(t) +
                                      (t < 0 ? "; before_start = \"hold\" keeps the object still until t = 0" : "")});
  }
  return source;
}

Pose FormulaMotion::pose(double t_s) const {
  Formulas& f = *formulas_;
  const double t = f.hold_before_start ? std::max(0.0, t_s) : t_s;
  Pose pose;
  for (std::size_t i = 0; i < 3; ++i) pose.position[static_cast<int>(i)] = f.value(i, t);
  if (f.turns) pose.orientation = Quat(Eigen::AngleAxisd(f.value(kAngle, t), f.axis));
  pose.position += pose.orientation * f.offset;
  if (f.spins) pose.orientation = pose.orientation * Eigen::AngleAxisd(f.value(kSpinAngle, t), f.spin_axis);
  return pose;
}

KinematicState FormulaMotion::sample(double t_s) const {
  Formulas& f = *formulas_;
  if (f.hold_before_start && t_s < 0.0) return at_rest(pose(0.0));
  KinematicState s;
  for (std::size_t i = 0; i < 3; ++i) {
    const RightDerivatives d = f.derivatives(i, t_s);
    const int along = static_cast<int>(i);
    s.position[along] = d.value;
    s.velocity[along] = d.first;
    s.acceleration[along] = d.second;
  }
  if (f.turns) {
    const RightDerivatives d = f.derivatives(kAngle, t_s);
    s.orientation = Quat(Eigen::AngleAxisd(d.value, f.axis));
    s.angular_velocity_body = d.first * f.axis;  // a turn about a fixed axis leaves that axis where it is in the body
    const Vec3 arm = s.orientation * f.offset, turned = f.axis.cross(arm);
    s.position += arm;
    s.velocity += d.first * turned;
    s.acceleration += d.second * turned + d.first * d.first * f.axis.cross(turned);
  } else {
    s.position += f.offset;
  }
  if (f.spins) {
    const RightDerivatives d = f.derivatives(kSpinAngle, t_s);
    const Quat spin(Eigen::AngleAxisd(d.value, f.spin_axis));
    s.orientation = s.orientation * spin;
    s.angular_velocity_body = spin.conjugate() * s.angular_velocity_body + d.first * f.spin_axis;
  }
  return s;
}

}  // namespace peerd::motion
