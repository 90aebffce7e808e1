/// The PID controller of a joint (docs/stance.md §4).
#pragma once

#include <verisq/stance_model.hpp>

namespace verisq::stance {

/// -Kp e - Ki (integral of e) - Kd q', N m or N, where e is the joint's position less the wanted one.
template <class T>
[[nodiscard]] T control_torque(const Controller& controller, const T& error, const T& integral_of_error,
                               const T& velocity) {
  return -(T(controller.proportional) * error) - T(controller.integral) * integral_of_error -
         T(controller.derivative) * velocity;
}

}  // namespace verisq::stance
