// A list that grows without being copied and becomes one vector in the end, with one block more than its length in
// memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include <sys/mman.h>

namespace matchlight {

template <class T>
class BlockList {
public:
    static_assert(std::is_trivially_copyable_v<T>);
    static constexpr std::size_t block_bytes = std::size_t{4} << 20;
    static constexpr std::size_t block_items = block_bytes / sizeof(T);

    /// Of an empty list: how long it will be, at least; then nothing is copied at all.
    void reserve(std::size_t size) { first_.reserve(size); }

    std::size_t size() const { return first_.size() + rest_size_; }
    /// Whether the next push_back takes more memory.
    bool is_full() const { return first_.size() == first_.capacity() && rest_size_ == rest_.size() * block_items; }

    void push_back(const T& item) {
        if (first_.size() < first_.capacity()) {
            first_.push_back(item);
            return;
        }
        if (is_full()) rest_.push_back(new_block());
        rest_[rest_size_ / block_items][rest_size_ % block_items] = item;
        ++rest_size_;
    }
    void resize(std::size_t size, const T& item) {
        if (this->size() == 0) reserve(size);
        while (this->size() < size) push_back(item);
    }
    T& operator[](std::size_t i) {
        if (i < first_.size()) return first_[i];
        i -= first_.size();
        return rest_[i / block_items][i % block_items];
    }

    /// The first `count` items as one vector; the list is empty then.
    std::vector<T> take(std::size_t count) {
        std::vector<T> all = std::move(first_);
        first_ = {};
        all.erase(all.begin() + static_cast<std::ptrdiff_t>(std::min(count, all.size())), all.end());
        all.reserve(count);
        for (Block& block : rest_) {
            const std::size_t items = std::min(block_items, count - all.size());
            all.insert(all.end(), block.get(), block.get() + items);
            block.reset();
        }
        rest_.clear();
        rest_size_ = 0;
        return all;
    }

private:
    struct Unmap {
        void operator()(T* items) const { munmap(items, block_bytes); }
    };
    using Block = std::unique_ptr<T[], Unmap>;
    /// From the system, which gets it back as soon as it is freed: malloc would keep some of that size.
    static Block new_block() {
        void* const memory = mmap(nullptr, block_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (memory == MAP_FAILED) throw std::bad_alloc();
        return Block(static_cast<T*>(memory));
    }

    std::vector<T> first_;
    std::vector<Block> rest_;
    std::size_t rest_size_ = 0;
};

}  // namespace matchlight
