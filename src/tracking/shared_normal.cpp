// Accumulates normal equations of shared unknowns.
#include "tracking/shared_normal.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "tracking/bundle_residuals.h"

namespace matchlight {

namespace {

constexpr double zeros[6] = {};

}  // namespace

SharedColumns::SharedColumns(const ClipModel& model, const ModelFreedom& freedom) {
    for (std::size_t i = 0; i < lens.size(); ++i) lens[i] = freedom.lens[i] ? count++ : -1;
    if (freedom.readout) readout = count++;
    if (freedom.plane_sigma_m) {
        plane = count;
        count += 3;
    }
    for (const auto& [id, tag] : model.tags) {
        if (!tag.held) {
            places[id] = count;
            count += 6;
        }
        if (freedom.corner_bias_px > 0) {
            offsets[id] = count;
            count += 8;
        }
    }
}

bool SharedColumns::any_lens() const {
    return std::ranges::any_of(lens, [](int column) { return column >= 0; });
}

SharedNormal& SharedNormal::operator+=(const SharedNormal& other) {
    information += other.information;
    gradient += other.gradient;
    return *this;
}

void SharedNormal::add_squares(const Eigen::VectorXd& residual, const Eigen::MatrixXd& jacobian,
                               const std::vector<int>& columns) {
    for (std::size_t a = 0; a < columns.size(); ++a) {
        if (columns[a] < 0) continue;
        const auto by_a = jacobian.col(static_cast<Eigen::Index>(a));
        gradient[columns[a]] += by_a.dot(residual);
        for (std::size_t b = 0; b < columns.size(); ++b) {
            if (columns[b] >= 0) {
                information(columns[a], columns[b]) += by_a.dot(jacobian.col(static_cast<Eigen::Index>(b)));
            }
        }
    }
}

SharedNormal normal_of_frames(const ClipModel& model, const ModelFreedom& freedom, const SharedColumns& columns,
                              std::span<const BundleFrame> frames) {
    SharedNormal sum(columns.count);
    for (const BundleFrame& frame : frames) {
        if (frame.views.empty()) continue;
        const FrameNormal normal = frame_normal(model, freedom, columns, frame);
        if (!normal.in_front) continue;
        const Eigen::LDLT<PoseCovariance> pose(normal.pose);
        const Eigen::MatrixXd reduced = normal.shared - normal.cross.transpose() * pose.solve(normal.cross);
        const Eigen::VectorXd right = normal.shared_right - normal.cross.transpose() * pose.solve(normal.pose_right);
        for (std::size_t a = 0; a < normal.columns.size(); ++a) {
            const auto row = static_cast<Eigen::Index>(a);
            sum.gradient[normal.columns[a]] -= right[row];
            for (std::size_t b = 0; b < normal.columns.size(); ++b) {
                sum.information(normal.columns[a], normal.columns[b]) += reduced(row, static_cast<Eigen::Index>(b));
            }
        }
    }
    return sum;
}

SharedNormal lens_prior_normal(const ClipModel& model, const ModelFreedom& freedom, const SharedColumns& columns) {
    SharedNormal normal(columns.count);
    if (!columns.any_lens()) return normal;
    const LensVector lens = lens_vector(model.camera);
    Eigen::Matrix<double, lens_parameter_count, lens_parameter_count, Eigen::RowMajor> jacobian;
    LensVector residual;
    const double* parameters[] = {lens.data()};
    double* jacobians[] = {jacobian.data()};
    const ceres::AutoDiffCostFunction<LensPriorResidual, lens_parameter_count, lens_parameter_count> cost(
        new LensPriorResidual{freedom.prior});
    cost.Evaluate(parameters, residual.data(), jacobians);
    normal.add_squares(residual, jacobian, {columns.lens.begin(), columns.lens.end()});
    return normal;
}

SharedNormal offset_prior_normal(const ClipModel& model, const SharedColumns& columns, double sigma_px) {
    SharedNormal normal(columns.count);
    for (const auto& [id, first] : columns.offsets) {
        const ModelTag& tag = model.tags.at(id);
        const double sigma_m = sigma_px * tag.metres_per_px;
        const Eigen::Map<const Eigen::Matrix<double, 8, 1>> offsets(tag.corner_offsets_m.data());
        normal.information.diagonal().segment<8>(first).array() += 1 / (sigma_m * sigma_m);
        normal.gradient.segment<8>(first) += offsets / (sigma_m * sigma_m);
    }
    return normal;
}

PlaneDeparture plane_departure(const ClipModel& model, const SharedColumns& columns, int id) {
    const ModelTag& tag = model.tags.at(id);
    const ceres::AutoDiffCostFunction<OnPlaneResidual, 3, 6, 3> cost(
        new OnPlaneResidual{tag.world_from_tag, model.world_from_plane, tag.size_m / 2, 1});
    Eigen::Matrix<double, 3, 6, Eigen::RowMajor> by_place;
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_plane;
    PlaneDeparture departure;
    const double* parameters[] = {zeros, zeros};
    double* jacobians[] = {by_place.data(), by_plane.data()};
    cost.Evaluate(parameters, departure.heights_m.data(), jacobians);
    departure.jacobian << by_place, by_plane;
    const auto place = columns.places.find(id);
    for (int i = 0; i < 6; ++i) departure.columns.push_back(place == columns.places.end() ? -1 : place->second + i);
    for (int i = 0; i < 3; ++i) departure.columns.push_back(columns.plane < 0 ? -1 : columns.plane + i);
    return departure;
}

SharedNormal prior_normal(const ClipModel& model, const ModelFreedom& freedom, const SharedColumns& columns) {
    SharedNormal normal = lens_prior_normal(model, freedom, columns);
    if (freedom.corner_bias_px > 0) normal += offset_prior_normal(model, columns, freedom.corner_bias_px);
    if (columns.readout >= 0) {
        const double precision = 1 / (freedom.readout_sigma_s * freedom.readout_sigma_s);
        normal.information(columns.readout, columns.readout) += precision;
        normal.gradient[columns.readout] += precision * model.readout_s;
    }
    if (!freedom.plane_sigma_m) return normal;
    for (const auto& [id, tag] : model.tags) {
        if (!tag.on_plane) continue;
        const PlaneDeparture departure = plane_departure(model, columns, id);
        normal.add_squares(departure.heights_m / *freedom.plane_sigma_m, departure.jacobian / *freedom.plane_sigma_m,
                           departure.columns);
    }
    return normal;
}

}  // namespace matchlight
