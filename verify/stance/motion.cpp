/// The motion of a body, free or held by controllers.
#include "verify/stance/motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <verisq/error.hpp>
#include <verisq/stance.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "verify/stance/controlled_motion.hpp"

namespace verisq::stance {
namespace {

double magnitude_of(const Enclosure& a) {
  return std::fmax(std::fabs(a.lo), std::fabs(a.hi));
}

Enclosure around(const Interval& a, double error) {
  const Interval wide = a + Interval(-error, error);
  return {wide.lower(), wide.upper()};
}

/// Puts the body into the file's posture, its lowest sole at this height.
void place_above_ground(const ControlledMotion& system, double height, std::vector<Interval>& state) {
  constexpr std::size_t upward = 1;
  Eigen::VectorXd place = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(state.size()));
  for (std::size_t j = 0; j < system.joints(); ++j)
    place[static_cast<Eigen::Index>(system.position(j))] = system.model().joints[j].wanted;
  double deepest = -infinity;
  for (const double penetration : penetrations_at(system, place)) deepest = std::fmax(deepest, penetration);
  place[static_cast<Eigen::Index>(system.position(upward))] += height + deepest;
  for (std::size_t j = 0; j < system.joints(); ++j) {
    const std::size_t i = system.position(j);
    state[i] = Interval(place[static_cast<Eigen::Index>(i)]);
  }
}

/// At rest, with the integrals of the equilibrium of the nominal parameters.
std::vector<Interval> start_of(const ControlledMotion& system, const MotionOptions& options) {
  const SagittalModel& sagittal = system.model();
  const Equilibrium nominal = equilibrium(sagittal.model, {}, {.control = JointControl::held});
  if (!nominal.standing || nominal.stands != 1.0)
    throw Error(ErrorKind::input, "simulation: the nominal model is not proven to stand, which is where it starts");
  std::vector<Interval> state(system.size(), Interval(0));
  for (std::size_t j = 0; j < system.joints(); ++j) {
    const Enclosure& position = nominal.standing->positions[sagittal.joints[j].joints.front()];
    state[system.position(j)] = Interval(position.lo, position.hi);
  }
  constexpr std::size_t upward = 1;
  state[system.position(upward)] += Interval(options.lift);
  if (options.drop) place_above_ground(system, *options.drop, state);
  for (std::size_t j = 3; j < system.joints(); ++j) {
    const SagittalJoint& joint = sagittal.joints[j];
    const Enclosure& torque = nominal.standing->torques[joint.joints.front()];
    if (joint.integral == 0.0 && magnitude_of(torque) > 0.0)
      throw Error(ErrorKind::input,
                  fmt::format("simulation: {} has no integral control, which is to hold it at first", joint.name));
  }
  for (std::size_t i = 0; i < system.integrals().size(); ++i) {
    const SagittalJoint& joint = sagittal.joints[system.integrals()[i]];
    const Enclosure& torque = nominal.standing->torques[joint.joints.front()];
    const Interval alike(static_cast<double>(joint.joints.size()));
    state[system.integral(i)] = -(alike * Interval(torque.lo, torque.hi) / Interval(joint.integral));
  }
  return state;
}

class Simulation {
 public:
  Simulation(const Model& model, UncertainSet uncertain, const MotionOptions& options)
      : options_(options),
        sagittal_(sagittal_model(model, uncertain)),
        system_(sagittal_, parameter_box(model, uncertain), options.push) {
    for (const SagittalJoint& joint : sagittal_.joints) result_.joints.push_back(joint.name);
    for (const SagittalContact& contact : sagittal_.contacts) result_.contacts.push_back(contact.name);
    breaks_ = system_.breaks();
    std::erase_if(breaks_, [&](double time) { return time <= 0.0 || time >= options.duration; });
    breaks_.push_back(options.duration);
    // Roundings of Taylor models' sizes are bounded for so many.
    constexpr std::size_t most_deviations = 32;
    if (system_.deviations() > most_deviations) {
      throw Error(ErrorKind::input, fmt::format("simulation: {} uncertain parameters act, at most {} may",
                                                system_.deviations(), most_deviations));
    }
    tolerance_ = system_.deviations() > 0 ? 1e-7 : 1e-11;
  }

  [[nodiscard]] Motion run() {
    try {
      begin();
    } catch (const std::domain_error&) {
      result_.open = "at its beginning the derivatives have no bound over these ranges";
    }
    while (result_.reached < options_.duration && result_.open.empty() && !result_.interrupted) {
      advance();
      if (options_.progress) options_.progress(result_.reached / options_.duration);
      result_.interrupted = options_.interrupted && options_.interrupted();
    }
    result_.proven = result_.reached == options_.duration;
    return std::move(result_);
  }

 private:
  void begin() {
    const std::vector<Interval> start = start_of(system_, options_);
    const auto n = static_cast<Eigen::Index>(start.size());
    const auto deviations = static_cast<Eigen::Index>(system_.deviations());
    at_ = {0.0, Eigen::VectorXd(n), Eigen::MatrixXd::Zero(n, deviations),
           Eigen::MatrixXd::Zero(n, deviations * (deviations + 1) / 2)};
    IntervalVector error(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Interval& x = start[static_cast<std::size_t>(i)];
      at_.state[i] = 0.5 * x.lower() + 0.5 * x.upper();
      error[i] = x - Interval(at_.state[i]);
    }
    for (std::size_t j = 0; j < system_.joints(); ++j) {
      const Interval& position = start[system_.position(j)];
      result_.positions.push_back({position.lower(), position.upper()});
      result_.velocities.push_back({0.0, 0.0});
    }
    const ModalBasis basis =
        modal_basis(approximate_derivatives(system_, at_.state, 0.0, regime_at(system_, at_.state, 0.0, 0.0)).by_state,
                    system_.tether());
    bound_ = {basis, lengths_of(basis, error)};
  }

  /// One step, or a shorter length to try, or the end.
  void advance() {
    constexpr double shortest = 1e-10;
    constexpr double nearly = 1e-9;
    double to = at_.time + length_;
    const double next = *std::ranges::upper_bound(breaks_, at_.time);
    if (window_) to = std::min(to, at_.time < window_->from ? window_->from : window_->to);
    if (to > next - nearly) to = next;
    try {
      if (attempt(to)) return;
    } catch (const std::domain_error&) {  // a form that has no value there
      length_ = 0.25 * (to - at_.time);
    }
    const double least = window_ ? std::min(shortest, 1e-3 * (window_->to - window_->from)) : shortest;
    if (length_ < least) result_.open = "the enclosure grows too fast to be followed";
  }

  [[nodiscard]] bool attempt(double to) {
    constexpr double after_switch = 1e-5;
    constexpr double least_controlled = 1e-9;
    const double length = to - at_.time;
    const double within = 0.5 * (at_.time + to);
    const bool switches = window_ && at_.time >= window_->from;
    const MotionRegime regime = regime_at(system_, at_.state, at_.time, within);
    auto step = collocation_step(system_, rule_, at_, to, regime);
    if (!step) return shortened(0.25, length);
    const Eigen::MatrixXd jacobian =
        approximate_derivatives(system_, Eigen::VectorXd(step->state.col(0)), within, regime).by_state;
    const ModalBasis fresh = modal_basis(jacobian, system_.tether());
    const double error = estimated_error(*step, regime, fresh, jacobian) / (tolerance_ * length + 1e-3 * tolerance_);
    const double factor = std::clamp(0.85 * std::pow(error, -1.0 / 6.0), 0.1, 4.0);
    if (error > 1.0 && length > least_controlled && !switches) return shortened(factor, length);
    if (!window_) {
      if (const auto time = first_switch(system_, *step, regime)) {
        look_at_switch(*time, regime);
        return false;
      }
    }
    add_second_order(system_, rule_, at_, regime, *step);
    const IntervalVector jump = missed(*step, -1.0);
    const ErrorBound start = widened(switches ? in_plain_basis() : in_better_basis(fresh, jacobian, length), jump);
    const bool may_be_open = switches || length <= open_length_ || system_.deviations() > 0;
    const auto bounded = bounded_step(system_, *step, start, !may_be_open);
    if (!bounded) return shortened(window_ && to == window_->from ? 0.9 : 0.25, length);
    record(*step, *bounded);
    at_ = end_of(*step);
    bound_ = widened(switches ? over_switch(*bounded, jump) : bounded->end, missed(*step, 1.0));
    length_ = std::min(factor * length, 0.02);
    open_length_ = bounded->regime.is_settled() ? least_open : 2.0 * open_length_;
    if (window_ && to >= window_->to) {
      window_.reset();
      length_ = std::max(length_, after_switch);
    }
    return true;
  }

  [[nodiscard]] bool shortened(double factor, double length) {
    length_ = factor * length;
    return false;
  }

  /// Steps are to end before the switch near `time`, and after it.
  void look_at_switch(double time, const MotionRegime& regime) {
    constexpr int corrections = 3;
    constexpr double margin = 2.0;  // the errors grow a little up to there
    for (int i = 0; i < corrections; ++i) {
      const double beyond = time + 1e-3 * (time - at_.time);
      const auto step = collocation_step(system_, rule_, at_, beyond, regime);
      const auto corrected = step ? first_switch(system_, *step, regime) : std::nullopt;
      if (!corrected) break;
      time = *corrected;
      if (i + 1 == corrections)
        window_ = switch_window(system_, *step, time, margin * components_of(bound_.basis, bound_.lengths));
    }
    if (!window_) window_ = SwitchWindow{at_.time, time + (time - at_.time)};
    length_ = (at_.time < window_->from ? window_->from : window_->to) - at_.time;
  }

  /// What one step adds to the error of positions: only a guess, which chooses the length of the step.
  [[nodiscard]] double estimated_error(const MotionPolynomial& step, const MotionRegime& regime,
                                       const ModalBasis& basis, const Eigen::MatrixXd& jacobian) const {
    const double half = 0.5 * (step.to - step.from);
    const double middle = step.from + half;
    const Eigen::MatrixXd modal = basis.inverse * jacobian * basis.modes;
    Eigen::VectorXd greatest = Eigen::VectorXd::Zero(jacobian.rows());
    for (const double t : {-1.0, -0.75, -0.2, 0.45, 0.9}) {
      const Eigen::VectorXd powers = RadauRule::powers(t);
      Eigen::VectorXd slopes = Eigen::VectorXd::Zero(powers.size());
      for (Eigen::Index i = 1; i < powers.size(); ++i) slopes[i] = static_cast<double>(i) * powers[i - 1] / half;
      const Eigen::VectorXd state = step.state * powers;
      const double time = middle + half * t;
      if (step.by_deviation.empty()) {
        const Eigen::VectorXd defect = step.state * slopes - approximate_rates(system_, state, time, regime);
        greatest = greatest.cwiseMax(Eigen::VectorXd((basis.inverse * defect).cwiseAbs()));
        continue;
      }
      const ApproximateRates rates = approximate_derivatives(system_, state, time, regime);
      Eigen::VectorXd sum = (basis.inverse * (step.state * slopes - rates.rates)).cwiseAbs();
      for (std::size_t k = 0; k < step.by_deviation.size(); ++k) {
        const Eigen::VectorXd defect = step.by_deviation[k] * slopes -
                                       rates.by_state * (step.by_deviation[k] * powers) -
                                       rates.by_deviation.col(static_cast<Eigen::Index>(k));
        sum += (basis.inverse * defect).cwiseAbs();
      }
      greatest = greatest.cwiseMax(sum);
    }
    for (Eigen::Index i = 0; i < greatest.size(); ++i)
      greatest[i] *= std::min(2.0 * half, 1.0 / (std::fabs(modal(i, i)) + 1e-300));
    const auto joints = static_cast<Eigen::Index>(system_.joints());
    return (basis.modes.cwiseAbs() * greatest).segment(joints, joints).maxCoeff();
  }

  /// The error hardly moves over a switch: it is that before it, whose modes are better known than its components, and
  /// the little that it moves.
  [[nodiscard]] ErrorBound over_switch(const BoundedStep& bounded, const IntervalVector& jump) const {
    constexpr double worse = 2.0;
    ErrorBound moved = widened(bound_, jump + symmetric(bounded.changes));
    const Eigen::VectorXd components = components_of(moved.basis, moved.lengths);
    return (components.array() <= worse * bounded.end_errors.array()).all() ? moved : bounded.end;
  }

  /// The modes of either side of a switch are none of the other's: their rates would be large in each other's modes.
  [[nodiscard]] ErrorBound in_plain_basis() const {
    const ModalBasis plain = plain_basis(at_.state.size());
    return {plain, lengths_in(plain, bound_.basis, bound_.lengths)};
  }

  /// Modes are kept as long as they serve: to change them costs a little each time.
  [[nodiscard]] ErrorBound in_better_basis(const ModalBasis& fresh, const Eigen::MatrixXd& jacobian,
                                           double length) const {
    constexpr double worth = 0.02;  // of the error
    if (length * (growth(bound_.basis, jacobian) - growth(fresh, jacobian)) <= worth) return bound_;
    return {fresh, lengths_in(fresh, bound_.basis, bound_.lengths)};
  }

  /// The greatest rate of growth that the comparison system has at one point: of blocks of one, an estimate.
  [[nodiscard]] static double growth(const ModalBasis& basis, const Eigen::MatrixXd& jacobian) {
    const Eigen::MatrixXd modal = basis.inverse * jacobian * basis.modes;
    Eigen::MatrixXd rates(basis.count(), basis.count());
    for (Eigen::Index a = 0; a < basis.count(); ++a) {
      const ModalBasis::Block& row = basis.blocks[static_cast<std::size_t>(a)];
      for (Eigen::Index b = 0; b < basis.count(); ++b) {
        const ModalBasis::Block& column = basis.blocks[static_cast<std::size_t>(b)];
        const IntervalMatrix part = modal.block(row.first, column.first, row.size, column.size).cast<Interval>();
        rates(a, b) = a == b ? logarithmic_norm(part) : spectral_norm(part);
      }
    }
    return rates.eigenvalues().real().maxCoeff();
  }

  /// By how much a polynomial misses, at its beginning (-1) or end (1), the numbers that two polynomials are to share:
  /// rounding errors, and part of the error. For all deviations.
  [[nodiscard]] IntervalVector missed(const MotionPolynomial& step, double end) const {
    IntervalVector jump(at_.state.size());
    for (Eigen::Index i = 0; i < jump.size(); ++i) {
      jump[i] = value_at(step.state, i, end) - Interval(at_.state[i]);
      const auto add = [&](const std::vector<Eigen::MatrixXd>& parts, const Eigen::MatrixXd& shared) {
        for (std::size_t k = 0; k < parts.size(); ++k) {
          const Interval difference = value_at(parts[k], i, end) - Interval(shared(i, static_cast<Eigen::Index>(k)));
          jump[i] += difference * Interval(-1.0, 1.0);
        }
      };
      add(step.by_deviation, at_.by_deviation);
      add(step.by_pair, at_.by_pair);
    }
    return jump;
  }

  [[nodiscard]] static IntervalVector symmetric(const Eigen::VectorXd& sizes) {
    IntervalVector result(sizes.size());
    for (Eigen::Index i = 0; i < sizes.size(); ++i) result[i] = Interval(-sizes[i], sizes[i]);
    return result;
  }

  [[nodiscard]] static ErrorBound widened(ErrorBound bound, const IntervalVector& jump) {
    const Eigen::VectorXd lengths = lengths_of(bound.basis, jump);
    for (Eigen::Index b = 0; b < lengths.size(); ++b)
      bound.lengths[b] = (Interval(bound.lengths[b]) + Interval(lengths[b])).upper();
    return bound;
  }

  void record(const MotionPolynomial& step, const BoundedStep& bounded) {
    const MotionPoint<DefectModel> tube = motion_point<DefectModel>(system_, step, bounded.errors, bounded.regime);
    const auto terms =
        system_.evaluate<DefectModel>(tube.state, tube.acceleration, tube.time, tube.regime, tube.deviations);
    MotionSlab slab{step.from, step.to, {}, {}, {}};
    const auto enclosure = [](const DefectModel& model) { return around(model.range(), 0.0); };
    for (std::size_t j = 0; j < system_.joints(); ++j) {
      slab.positions.push_back(enclosure(tube.state[system_.position(j)]));
      slab.velocities.push_back(enclosure(tube.state[j]));
      result_.positions[j] = at_end(step, bounded, system_.position(j));
      result_.velocities[j] = at_end(step, bounded, j);
    }
    for (const ContactForce<DefectModel>& contact : terms.contacts) {
      MotionContact forces{enclosure(contact.normal), enclosure(contact.friction)};
      forces.normal.lo = std::fmax(forces.normal.lo, 0.0);  // by its law
      slab.contacts.push_back(forces);
    }
    result_.slabs.push_back(std::move(slab));
    result_.reached = step.to;
  }

  static Interval value_at(const Eigen::MatrixXd& polynomial, Eigen::Index row, double end) {
    Interval value(0);
    for (Eigen::Index power = 0; power < polynomial.cols(); ++power)
      value += Interval(end < 0.0 && power % 2 == 1 ? -polynomial(row, power) : polynomial(row, power));
    return value;
  }

  static Enclosure at_end(const MotionPolynomial& step, const BoundedStep& bounded, std::size_t component) {
    const auto i = static_cast<Eigen::Index>(component);
    Interval sum = value_at(step.state, i, 1.0);
    for (const std::vector<Eigen::MatrixXd>* parts : {&step.by_deviation, &step.by_pair}) {
      for (const Eigen::MatrixXd& part : *parts) sum += value_at(part, i, 1.0) * Interval(-1.0, 1.0);
    }
    return around(sum, bounded.end_errors[i]);
  }

  const MotionOptions& options_;
  SagittalModel sagittal_;
  ControlledMotion system_;
  RadauRule rule_;
  double tolerance_;
  std::vector<double> breaks_;
  static constexpr double least_open = 1e-9;  ///< s
  double length_ = 1e-4;
  double open_length_ = least_open;     ///< s: no longer may a step be in which it is open which branches hold
  std::optional<SwitchWindow> window_;  ///< of the next switch
  ApproximateState at_;
  ErrorBound bound_;
  Motion result_;
};

}  // namespace

Motion simulate(const Model& model, UncertainSet uncertain, const MotionOptions& options) {
  return Simulation(model, uncertain, options).run();
}

namespace motion_details {

AffineDamping::AffineDamping(const Interval& restitution)
    : middle(0.5 * restitution.lower() + 0.5 * restitution.upper()),
      at_middle(damping_factor(Interval(middle))),
      slope(damping_slope(Interval(middle), at_middle)),
      rest(0) {
  if (restitution.lower() == restitution.upper()) return;
  const Interval change = restitution - Interval(middle);
  rest = (damping_slopes(restitution) - slope) * change;
}

}  // namespace motion_details

ControlledMotion::ControlledMotion(const SagittalModel& model, std::vector<Interval> box, std::optional<Push> push)
    : model_(model), push_(push) {
  for (std::uint32_t i = 0; i < box.size(); ++i) {
    const double centre = 0.5 * box[i].lower() + 0.5 * box[i].upper();
    centre_.push_back(centre);
    if (box[i].lower() == box[i].upper()) continue;
    uncertain_.push_back(i);
    radius_.push_back(std::max((Interval(centre) - Interval(box[i].lower())).upper(),
                               (Interval(box[i].upper()) - Interval(centre)).upper()));
  }
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    if (model.joints[j].integral != 0.0) integrals_.push_back(j);
  }
  for (const SagittalContact& contact : model.contacts) {
    const Quantity& restitution = model.model.cylinders[contact.cylinder].normal_restitution;
    damping_.emplace_back(value_of<Interval>(restitution, box));
  }
}

Eigen::MatrixXd ControlledMotion::tether() const {
  constexpr double frequency = 10.0;  // 1/s
  constexpr std::size_t of_root = 3;
  const auto n = static_cast<Eigen::Index>(size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t j = 0; j < of_root; ++j) {
    const double distinct = frequency * (1.0 + 0.1 * static_cast<double>(j));  // equal ones would nearly coincide again
    const auto velocity = static_cast<Eigen::Index>(j);
    result(velocity, static_cast<Eigen::Index>(position(j))) = -distinct * distinct;
    result(velocity, velocity) = -distinct;
  }
  return result;
}

std::vector<double> ControlledMotion::breaks() const {
  if (!push_) return {};
  return {push_->start, push_->start + push_->duration};
}

}  // namespace verisq::stance
