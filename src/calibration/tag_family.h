// The families of AprilTags that can be tracked, and the black-and-white pattern each id prints.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

struct apriltag_family;

namespace matchlight {

/// The printed cells of one tag, row 0 at the top of the sheet. Cell (x, y) spans [x, x + 1] × [y, y + 1] of the tag's
/// grid; the detection corners lie at `border_begin` and `border_end` on both axes.
struct TagPattern {
    enum Ink : std::int8_t { unknown = -1, black = 0, white = 1 };

    int cells = 0;  // along a side
    double border_begin = 0, border_end = 0;
    std::vector<Ink> ink;

    Ink at(int x, int y) const { return ink[static_cast<std::size_t>(y) * cells + x]; }
};

/// One of AprilTag's families (Olson 2011; Wang & Olson 2016; Krogius et al. 2019), owned.
class TagFamily {
public:
    /// "tag36h11", "tag25h9", "tag16h5", "tagStandard41h12", "tagCircle21h7".
    static const std::vector<std::string>& names();

    /// `name` must be one of names().
    explicit TagFamily(const std::string& name);

    const std::string& name() const { return name_; }
    int id_count() const;
    TagPattern pattern(int id) const;
    /// Wrong bits that are tolerated in a detection: the library corrects two at most, and small families none,
    /// because in clutter a 16-bit word lies within one bit of some code 8 % of the time.
    int allowed_hamming() const;

    /// For the detector that decodes it; a family serves one detector only.
    apriltag_family* get() const { return family_.get(); }

private:
    std::string name_;
    std::unique_ptr<apriltag_family, void (*)(apriltag_family*)> family_;
};

}  // namespace matchlight
