// Memory of handles. A freed handle says so, as long as its memory is not used again: after 2^20 other handles of its kind were
// freed. A handle takes 16 to 24 bytes, so a program that frees as many keeps 24 MB of them.
#pragma once

#include <cstdlib>
#include <cstring>
#include <mutex>
#include <new>

#include "base/aligned.hpp"
#include "guard.hpp"

namespace dyn::capi {

template <class H>
class Pool {
 public:
  static constexpr std::size_t most_freed = std::size_t(1) << 20;

  // Never destroyed: handles may outlive static objects. A library that is unloaded gives its memory back, if no handle is left.
  static Pool& shared() {
    alignas(Pool) static char memory[sizeof(Pool)];
    static Pool* const pool = new (memory) Pool;
    static const struct Last {
      ~Last() { pool->give_back(); }
    } last;
    return *pool;
  }
  // nullptr: there is no memory.
  H* get() {
    const std::lock_guard lock(mutex);
    if (count > most_freed) {
      H* h = first;
      first = next_of(h);
      --count, ++held;
      return h;
    }
    if (!left) {
      auto* chunk = static_cast<char*>(allocate_aligned(64, chunk_bytes));
      if (!chunk) return nullptr;
      std::memcpy(chunk, &chunks, sizeof chunks);  // leak checkers look for it
      chunks = chunk, left = per_chunk;
    }
    ++held;
    return new (chunks + 64 + --left * sizeof(H)) H{};
  }
  void put(H* h) {
    const std::lock_guard lock(mutex);
    h->magic = freed;
    set_next(h, nullptr);
    if (count++) set_next(last, h);
    else first = h;
    last = h, --held;
  }

 private:
  void give_back() {
    const std::lock_guard lock(mutex);
    if (held > 0) return;
    while (char* const chunk = chunks) {
      std::memcpy(&chunks, chunk, sizeof chunks);
      free_aligned(chunk);
    }
    left = count = 0;
  }

  static constexpr std::size_t chunk_bytes = 4096, per_chunk = (chunk_bytes - 64) / sizeof(H);
  static_assert(sizeof(H) >= sizeof(std::uint64_t) + sizeof(H*));

  // Behind the magic of a freed handle.
  static H* next_of(const H* h) {
    H* next;
    std::memcpy(&next, reinterpret_cast<const char*>(h) + sizeof h->magic, sizeof next);
    return next;
  }
  static void set_next(H* h, H* next) { std::memcpy(reinterpret_cast<char*>(h) + sizeof h->magic, &next, sizeof next); }

  std::mutex mutex;
  char* chunks = nullptr;
  std::size_t left = 0, count = 0, held = 0;  // handles never used yet in the first chunk, freed ones, and the others
  H *first = nullptr, *last = nullptr;
};

template <class H>
H* new_handle() {
  return Pool<H>::shared().get();
}
template <class H>
void free_handle(H* h) {
  Pool<H>::shared().put(h);
}

}  // namespace dyn::capi
