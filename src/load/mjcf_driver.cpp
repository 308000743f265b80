// <pid> and <dcmotor>: actuators with a controller of their own.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

// Words of input in their order; 0: there is none.
std::optional<std::uint32_t> read_inputs(const Reader& reader, const Element& e, bool motor) {
  constexpr std::pair<std::string_view, std::uint32_t> words[] = {
      {"pos", DYN_INPUT_POSITION}, {"vel", DYN_INPUT_VELOCITY}, {"ff", DYN_INPUT_FORCE}, {"voltage", DYN_INPUT_VOLTAGE}};
  if (!e.Attribute("input")) return std::nullopt;
  std::istringstream given(attribute(e, "input"));
  std::uint32_t bits = 0;
  for (std::string word; given >> word;) {
    if (motor && word == "none") continue;
    const auto at = std::find_if(std::begin(words), std::end(words) - !motor, [&](const auto& w) { return w.first == word; });
    if (at == std::end(words) - !motor || bits >= at->second)
      reader.fail(DYN_ERROR_PARSE, e, "input has " + load::in_quotes(word) + ": words of pos, vel, ff" +
                                          (motor ? ", voltage" : "") + " in this order are expected");
    bits |= at->second;
  }
  return bits;
}

// Up to n numbers; those that are missing are 0.
std::vector<double> some(const Reader& reader, const Element& e, const char* attribute, size_t n) {
  std::vector<double> x = reader.numbers(e, attribute).value_or(std::vector<double>());
  if (x.size() > n) reader.bad_numbers(e, attribute, "there are more than " + std::to_string(n));
  x.resize(n);
  return x;
}

void read_motor(const Reader& reader, const Element& e, dynActuator& a) {
  dynDcMotor& x = a.motor;
  const std::vector<double> constants = some(reader, e, "motorconst", 2), nominal = some(reader, e, "nominal", 3),
                            most = some(reader, e, "saturation", 3), inductance = some(reader, e, "inductance", 2),
                            controller = some(reader, e, "controller", 6), thermal = some(reader, e, "thermal", 6),
                            lugre = some(reader, e, "lugre", 5), cogging = some(reader, e, "cogging", 3);
  double R = reader.optional_number(e, "resistance").value_or(0), Kt = constants[0], Ke = constants[1];
  const double V = nominal[0], stall = nominal[1], free_speed = nominal[2], B = some(reader, e, "damping", 3)[0];
  if (V > 0 && Ke <= 0 && free_speed > 0) {  // free_speed = V Ke / (Ke^2 + R B)
    Ke = V / free_speed;
    const double square = V * V - 4 * R * B * free_speed * free_speed;
    if (B > 0 && R > 0 && square > 0) Ke = (V + std::sqrt(square)) / (2 * free_speed);
    if (B > 0 && R <= 0 && stall > 0 && V / free_speed > V * B / stall) Ke = V / free_speed - V * B / stall;
  }
  const double K = Kt > 0 && Ke > 0 ? std::sqrt(Kt * Ke) : Kt > 0 ? Kt : Ke;
  if (R == 0 && V > 0 && stall > 0 && K > 0) R = K * V / stall;
  if (!(K > 0)) reader.bad_numbers(e, "motorconst", "the motor constant must be positive");
  if (!(R > 0)) reader.bad_numbers(e, "resistance", "it must be positive");
  x.resistance = R, x.constant = K;
  x.kp = controller[0], a.ki = controller[1], x.kd = controller[2], a.slew = controller[3], a.integral_limit = controller[4];
  x.voltage_limit = std::max(0.0, controller[5]);
  if (most[0] > 0 || most[1] > 0) {
    const double force = most[0] == 0 ? K * most[1] : most[0];
    a.force_range[0] = -force, a.force_range[1] = force;
  }
  x.rate = std::max(0.0, most[2]), x.time_constant = inductance[0] > 0 ? inductance[0] / R : inductance[1];
  std::copy_n(cogging.begin(), 3, x.cogging);
  if (thermal[0] > 0 || thermal[1] > 0 || thermal[2] > 0) {
    x.thermal_resistance = thermal[0], x.heat_capacity = thermal[1];
    if (thermal[2] > 0 && thermal[0] > 0 && thermal[1] == 0) x.heat_capacity = thermal[2] / thermal[0];
    if (thermal[2] > 0 && thermal[1] > 0 && thermal[0] == 0) x.thermal_resistance = thermal[2] / thermal[1];
    if (!(x.thermal_resistance > 0 && x.heat_capacity > 0))
      reader.bad_numbers(e, "thermal", "resistance and capacitance must follow from it, and be positive");
    x.temperature_coefficient = thermal[3], x.reference = thermal[4], x.ambient = thermal[5];
  }
  if (lugre[0] > 0)
    x.bristle_stiffness = lugre[0], x.bristle_damping = lugre[1], x.coulomb = lugre[2], x.breakaway = lugre[3],
    x.stribeck = lugre[4];
}

}  // namespace

void read_mjcf_driver(const Reader& reader, const Element& e, bool autolimits, MjcfActuator& actuator) {
  dynActuator& a = actuator.spec;
  const bool motor = std::string_view(e.Name()) == "dcmotor";
  a.type = motor ? DYN_ACTUATOR_TYPE_DC_MOTOR : DYN_ACTUATOR_TYPE_PID;
  a.inputs = read_inputs(reader, e, motor).value_or(motor ? DYN_INPUT_VOLTAGE : DYN_INPUT_POSITION | DYN_INPUT_VELOCITY);
  const auto range = [&](const char* attribute, double (&to)[2]) {
    read_mjcf_range(reader, e, attribute, "ctrllimited", autolimits, to);
  };
  if (e.Attribute("velrange")) range("velrange", a.velocity_range);
  if (e.Attribute("ffrange")) range("ffrange", a.feedforward_range);
  if (motor) return read_motor(reader, e, a);
  if (e.Attribute("posrange")) range("posrange", a.control_range);
  const auto number = [&](const char* attribute) { return reader.optional_number(e, attribute); };
  const auto kv = number("kv"), ratio = number("dampratio");
  a.kp = number("kp").value_or(0), a.kv = kv.value_or(0);
  if (kv && ratio) reader.fail(DYN_ERROR_INVALID, e, "it has kv and dampratio: give one of them");
  if (ratio) actuator.damping_ratio = *ratio;
  a.ki = std::max(0.0, number("ki").value_or(0)), a.slew = number("slewmax").value_or(0);
  a.integral_limit = a.ki > 0 ? number("imax").value_or(0) : 0;
}

}  // namespace dyn::load
