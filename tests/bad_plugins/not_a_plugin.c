/* A shared library that has nothing to do with lahar. */
int answer(void);

int answer(void) { return 42; }
