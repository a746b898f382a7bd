// Curves of translation, rotation and scale.
#include "scene/object_motion.h"

#include <cmath>
#include <numbers>

#include "core/transforms.h"
#include "scene/key_curve.h"

namespace matchlight {
namespace {

constexpr double full_turn = 2 * std::numbers::pi;

Eigen::Matrix3d rotation_by(const Eigen::Vector3d& rotation_vector) {
    const double angle = rotation_vector.norm();
    if (angle == 0) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
}

/// Of all rotation vectors (axis · angle) of a rotation, which differ by full turns, the one nearest to `expected`.
Eigen::Vector3d rotation_vector_near(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& expected) {
    const Eigen::AngleAxisd shortest(rotation);
    // A rotation by less has no axis of its own within rounding.
    constexpr double least_angle = 1e-9;
    const bool has_axis = shortest.angle() > least_angle || expected.norm() < least_angle;
    const Eigen::Vector3d axis = has_axis ? shortest.axis() : expected.normalized();
    const double angle = has_axis ? shortest.angle() : 0;
    return axis * (angle + full_turn * std::round((axis.dot(expected) - angle) / full_turn));
}

/// How the object turns from one key to the next, about the world's axes.
Eigen::Vector3d turn_between(const ObjectKey& from, const ObjectKey& to) {
    const Eigen::Vector3d radians = (to.rotate_deg - from.rotate_deg) * (std::numbers::pi / 180);
    const Eigen::Matrix3d before = rotation_from_degrees(from.rotate_deg);
    // What changing each of the degrees by itself would do: R = Rz·Ry·Rx turns about the world's z, the y that z has
    // turned, and the x that both have.
    const Eigen::Vector3d y_axis = rotation_from_degrees({0, 0, from.rotate_deg.z()}) * Eigen::Vector3d::UnitY();
    const Eigen::Vector3d x_axis = before * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d expected =
        radians.x() * x_axis + radians.y() * y_axis + radians.z() * Eigen::Vector3d::UnitZ();
    return rotation_vector_near(rotation_from_degrees(to.rotate_deg) * before.transpose(), expected);
}

Eigen::Matrix3d rotation_at(const std::vector<ObjectKey>& keys, double frame) {
    const KeySpan span = span_of(keys, frame);
    const std::size_t i = span.from;
    const Eigen::Matrix3d start = rotation_from_degrees(keys[i].rotate_deg);
    if (span.step == 0) return start;
    const auto slope = [&](std::size_t from) -> Eigen::Vector3d {
        return turn_between(keys[from], keys[from + 1]) / static_cast<double>(keys[from + 1].frame - keys[from].frame);
    };
    // The three parts of a cubic Bézier curve, turned one after the other about the world's axes.
    const Eigen::Vector3d whole = turn_between(keys[i], keys[i + 1]);
    const Eigen::Vector3d first = tangent_at(keys, i, slope) * (span.step / 3);
    const Eigen::Vector3d last = tangent_at(keys, i + 1, slope) * (span.step / 3);
    const Eigen::Vector3d middle = rotation_vector_near(
        rotation_by(-last) * rotation_from_degrees(keys[i + 1].rotate_deg) * start.transpose() * rotation_by(-first),
        whole - first - last);
    const double t = span.t, rest = 1 - t;
    const double first_share = 1 - rest * rest * rest, middle_share = t * t * (3 - 2 * t), last_share = t * t * t;
    return rotation_by(last_share * last) * rotation_by(middle_share * middle) * rotation_by(first_share * first) *
           start;
}

Eigen::Matrix3d spun(const SpinSettings& spin, double time_s) {
    // Whole turns are taken off first: a long clip loses no digits.
    double whole = 0;
    const double angle = full_turn * std::modf(spin.turns_per_second * time_s, &whole);
    return Eigen::AngleAxisd(angle, spin.axis.normalized()).toRotationMatrix();
}

}  // namespace

bool moves(const ObjectSettings& object) {
    return object.keys.size() > 1 || (object.spin && object.spin->turns_per_second != 0);
}

Eigen::Affine3d object_placement(const ObjectSettings& object, const ClipTime& time) {
    Eigen::Vector3d translate_m = object.translate_m, scale = object.scale;
    Eigen::Matrix3d rotation;
    if (object.keys.empty()) {
        rotation = rotation_from_degrees(object.rotate_deg);
    } else {
        translate_m = between_keys(object.keys, time.frame, [](const ObjectKey& key) { return key.translate_m; });
        const Eigen::Vector3d log_scale = between_keys(
            object.keys, time.frame, [](const ObjectKey& key) -> Eigen::Vector3d { return key.scale.array().log(); });
        scale = log_scale.array().exp();
        rotation = rotation_at(object.keys, time.frame);
    }
    if (object.spin) rotation = spun(*object.spin, time.time_s) * rotation;
    return Eigen::Translation3d(translate_m) * rotation * Eigen::Scaling(scale);
}

}  // namespace matchlight
