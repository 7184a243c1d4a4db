"""A barrier for the threads of one launch on the CPU."""

import warp as wp

wp.set_module_options({"enable_backward": False})


@wp.func_native("""
#if !defined(__CUDA_ARCH__)
    // The linker finds the system's own function: a thread that waits long gives its core away.
    extern int give_way(void) __asm__("sched_yield");
    __atomic_add_fetch(&arrived.data[0], 1, __ATOMIC_ACQ_REL);
    int spins = 0;
    while (__atomic_load_n(&arrived.data[0], __ATOMIC_ACQUIRE) < wanted)
        if (++spins % 16384 == 0)
            give_way();
#endif
""")
def wait_for_all(arrived: wp.array[int], wanted: int):
    """Counts this thread in and waits until ``wanted`` have been: what they wrote before is then seen.

    Warp's own atomics are not atomic between launches of several threads on the CPU. ``arrived`` starts at 0
    and is never set back: the k-th barrier of n threads waits for k n. Alone, a thread does not wait. On
    CUDA, where such a kernel would be launched with one index, this does nothing.
    """
