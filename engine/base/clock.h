// clock.h: clocks for measuring; never an input of the simulation.
#ifndef LUZ_CLOCK_H
#define LUZ_CLOCK_H
#include "base.h"
f64 clock_now_ms(void);         // monotonic wall clock
f64 clock_process_cpu_ms(void); // user + system time of the whole process, all threads included
f64 clock_thread_cpu_ms(void);
#endif
