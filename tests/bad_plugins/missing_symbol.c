/* A library that the system cannot load: it needs a function that nobody has. */
int nobody_has_this_function(void);
int (*needed)(void) = nobody_has_this_function;
