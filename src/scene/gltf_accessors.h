// Typed arrays inside glTF buffers: checked against the bytes there are, and read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/gltf_document.h"

namespace matchlight {

struct GltfBufferView {
    std::size_t buffer = 0;
    std::uint64_t offset = 0, length = 0, stride = 0;  // bytes; stride 0: packed
};

struct GltfAccessor {
    std::optional<std::size_t> view;  // absent: zeros
    std::uint64_t offset = 0;         // bytes into the view
    std::uint64_t count = 0;
    int component_type =
        0;               // 5120 byte, 5121 unsigned byte, 5122 short, 5123 unsigned short, 5125 unsigned, 5126 float
    int components = 0;  // 1, 2, 3, 4, 9 or 16
    bool normalized = false;

    struct Sparse {
        std::uint64_t count = 0;
        std::size_t index_view = 0, value_view = 0;
        std::uint64_t index_offset = 0, value_offset = 0;
        int index_type = 0;
    };
    std::optional<Sparse> sparse;
};

/// All accessors of a document, each checked when this is made.
class GltfAccessors {
public:
    /// Throws InputError: an accessor or sparse index beyond its buffer, unknown types, more elements than fit into
    /// memory.
    explicit GltfAccessors(const GltfDocument& document);

    const std::vector<GltfAccessor>& accessors() const { return accessors_; }
    const std::vector<GltfBufferView>& views() const { return views_; }

    /// The elements as floats, normalised integers as the specification says (section 3.6.2.2).
    std::vector<float> floats(std::size_t accessor) const;
    /// The elements of a scalar accessor of unsigned integers.
    std::vector<std::uint32_t> indices(std::size_t accessor) const;
    /// Whether every loader reads the bytes as they stand: packed or strided floats (or scalar unsigned integers).
    bool is_plain(std::size_t accessor) const;

private:
    GltfAccessor read_accessor(std::size_t number) const;
    void check_span(std::size_t view, std::uint64_t offset, std::uint64_t count, std::uint64_t element_bytes,
                    const std::string& where) const;
    const char* bytes_of(std::size_t view, std::uint64_t offset) const;
    template <class Value, class Convert>
    std::vector<Value> read(const GltfAccessor& accessor, const Convert& convert) const;

    const GltfDocument& document_;
    std::vector<GltfBufferView> views_;
    std::vector<GltfAccessor> accessors_;
};

}  // namespace matchlight
