/* A library that another one needs. */
int needed(void);
int needed(void) { return 1; }
