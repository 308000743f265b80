// What the tests of this program count and provoke in place of libc's functions. (Not under sanitizers, which bring their own.)
#pragma once

#include <atomic>

// Of the calling thread: calls that allocate or free, and that lock; blocks allocated and not freed.
extern thread_local long allocations, locks, blocks;
// The allocation after so many more returns NULL, and all that follow it; below zero: none does.
extern thread_local long until_no_memory;
// Whether it was asked for by urdfdom or its parser, TinyXML, which lose a block when there is none.
extern thread_local bool refused_urdfdom;
// Allocations and locks of all threads; calls of syscall(), which is how threads are woken.
extern std::atomic<long> anywhere, system_calls;
