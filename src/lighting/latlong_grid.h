// Exact integrals over the pixels of a lat-long image, which all sums over a probe are built from.
#pragma once

#include <vector>

namespace matchlight {

/// Integrals over one row of pixels, θ from straight up (z = cos θ) between its upper and lower edge. A pixel's
/// integral of a separable function over solid angle is (row's part) × (column's part).
struct LatlongRow {
    double z_top = 0, z_bottom = 0;
    double sin1 = 0;       // ∫ sin θ dθ
    double sin1_cos1 = 0;  // ∫ sin θ cos θ dθ
    double sin1_cos2 = 0;  // ∫ sin θ cos² θ dθ
    double sin2 = 0;       // ∫ sin² θ dθ
    double sin2_cos1 = 0;  // ∫ sin² θ cos θ dθ
    double sin3 = 0;       // ∫ sin³ θ dθ
};

/// Integrals over one column of pixels; φ is the azimuth from world +y towards +x: x = sin θ sin φ, y = sin θ cos φ.
struct LatlongColumn {
    double sine = 0;           // ∫ sin φ dφ
    double cosine = 0;         // ∫ cos φ dφ
    double double_sine = 0;    // ∫ sin 2φ dφ
    double double_cosine = 0;  // ∫ cos 2φ dφ
};

class LatlongGrid {
public:
    LatlongGrid(int width, int height);

    int width() const { return static_cast<int>(columns_.size()); }
    int height() const { return static_cast<int>(rows_.size()); }
    const LatlongRow& row(int y) const { return rows_[static_cast<std::size_t>(y)]; }
    const LatlongColumn& column(int x) const { return columns_[static_cast<std::size_t>(x)]; }
    /// Width of a pixel in azimuth, radians.
    double azimuth_step() const { return azimuth_step_; }
    /// Solid angle of every pixel in the row, steradians.
    double solid_angle(int y) const { return row(y).sin1 * azimuth_step_; }

    /// The integrals of the part of row `y` that lies at world z ≥ `minimum_z`; all zero where none does.
    LatlongRow row_above(int y, double minimum_z) const;

private:
    std::vector<LatlongRow> rows_;
    std::vector<LatlongColumn> columns_;
    double azimuth_step_;
};

}  // namespace matchlight
