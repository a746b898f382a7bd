// A list that grows without being copied and becomes one vector in the end, with one block more than its length in
// memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace matchlight {

template <class T>
class BlockList {
public:
    /// Large enough that the system takes a block back at once when it is freed.
    static constexpr std::size_t block_items = (64u << 20) / sizeof(T);

    std::size_t size() const { return size_; }
    /// Whether the next push_back takes a new block.
    bool is_full() const { return size_ == blocks_.size() * block_items; }

    void push_back(const T& item) {
        if (is_full()) blocks_.push_back(std::make_unique_for_overwrite<T[]>(block_items));
        blocks_[size_ / block_items][size_ % block_items] = item;
        ++size_;
    }
    void resize(std::size_t size, const T& item) {
        while (size_ < size) push_back(item);
    }
    T& operator[](std::size_t i) { return blocks_[i / block_items][i % block_items]; }

    /// The first `count` items as one vector; the list is empty then.
    std::vector<T> take(std::size_t count) {
        std::vector<T> all;
        all.reserve(count);
        for (std::unique_ptr<T[]>& block : blocks_) {
            const std::size_t items = std::min(block_items, count - all.size());
            all.insert(all.end(), block.get(), block.get() + items);
            block.reset();
        }
        blocks_.clear();
        size_ = 0;
        return all;
    }

private:
    std::vector<std::unique_ptr<T[]>> blocks_;
    std::size_t size_ = 0;
};

}  // namespace matchlight
