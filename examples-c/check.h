/* check.h: what every driver does with statuses and numbers. */

#ifndef CHECK_H
#define CHECK_H

#include <lahar/lahar.h>
#include <stdio.h>
#include <stdlib.h>

/* Ends the program with the message of lahar if a call was refused or failed. */
static inline void check(lahar_status status) {
    char text[1024] = "";
    if (status == LAHAR_OK) return;
    lahar_last_error_message(text, (int64_t)sizeof text, NULL);
    fprintf(stderr, "%s: %s\n", lahar_status_name(status), text);
    exit(1);
}

/* Ends the program if memory is short. */
static inline double *doubles(int64_t count) {
    double *memory = (double *)malloc((size_t)count * sizeof(double));
    if (memory != NULL) return memory;
    fprintf(stderr, "no memory for %lld doubles\n", (long long)count);
    exit(1);
}

/* One line `name = value` that reads back to the same double. */
static inline void print(const char *name, double value) {
    printf("%s = %.17g\n", name, value);
}

#endif
