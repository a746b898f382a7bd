// bgeo of Houdini before version 12, as Partio writes it: points with attributes, big-endian, mostly gzipped.
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/binary_number.h"
#include "scene/sphere_readers.h"

namespace matchlight {
namespace {

class BgeoReader {
public:
    BgeoReader(ChunkedFile& file, SphereBuilder& builder) : file_(file), builder_(builder) {}

    void read() {
        if (file_.bytes(5, "its header") != "BgeoV") {
            throw InputError(file_.path(), "it is no bgeo file of the classic kind", "save it as .bgeo version 5");
        }
        if (const std::uint64_t version = whole(4); version != 5) {
            throw InputError(file_.path(), fmt::format("its version is {}", version), "save it as version 5");
        }
        const std::uint64_t points = whole(4);
        file_.skip(12, "its header");  // primitives, and groups of points and primitives
        const std::uint64_t attributes = whole(4);
        file_.skip(12, "its header");  // attributes of vertices, primitives and the whole
        for (std::uint64_t i = 0; i < attributes; ++i) read_attribute();
        constexpr std::size_t place_bytes = 16;  // x, y, z, w
        const std::size_t point_bytes = place_bytes + 4 * fields_.size();
        if (point_bytes > ChunkedFile::chunk_bytes)
            throw InputError(file_.path(), "its points have too many attributes");
        file_.check_count(points, point_bytes, "points");
        builder_.begin(points);
        for (std::uint64_t i = 0; i < points; ++i) {
            const char* at = file_.bytes(point_bytes, "its points").data();
            SphereRecord record;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                record.centre[axis] = number_at(at + 4 * axis, NumberType::float32, true);
            }
            at += place_bytes;
            for (const Field& field : fields_) {
                if (field.wanted.any()) record.put(field.wanted, number_at(at, field.type, true));
                at += 4;
            }
            builder_.add(record);
        }
    }

private:
    /// A component of an attribute, four bytes each.
    struct Field {
        NumberType type = NumberType::float32;
        SphereValues wanted;
    };

    std::uint64_t whole(std::size_t bytes) { return bits_at(file_.bytes(bytes, "its header").data(), bytes, true); }
    std::string text() {
        const std::uint64_t length = whole(2);
        return std::string(file_.bytes(length, "its header"));
    }
    void read_attribute() {
        enum { floats = 0, integers = 1, strings = 4, vectors = 5 };
        const std::string name = text();
        const std::uint64_t size = whole(2), type = whole(4);
        if (type == strings) {
            const std::uint64_t count = whole(4);
            for (std::uint64_t i = 0; i < count; ++i) text();
        } else if (type == floats || type == integers || type == vectors) {
            file_.skip(4 * size, "its header");  // the defaults
        } else {
            throw InputError(file_.path(), fmt::format("its attribute '{}' is of the unknown type {}", name, type));
        }
        for (std::uint64_t i = 0; i < size; ++i) {
            Field field;
            field.type = type == floats || type == vectors ? NumberType::float32 : NumberType::int32;
            field.wanted = builder_.claim(size == 1 ? name : fmt::format("{}_{}", name, i));
            fields_.push_back(field);
        }
    }

    ChunkedFile& file_;
    SphereBuilder& builder_;
    std::vector<Field> fields_;
};

}  // namespace

void read_bgeo_spheres(ChunkedFile& file, SphereBuilder& builder) {
    BgeoReader(file, builder).read();
}

}  // namespace matchlight
