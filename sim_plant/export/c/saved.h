/* A line's memory as bytes: a mark of the model and of its form, then the memory. */

#include <stdlib.h>

typedef struct {
    char token[64];
    uint64_t size;
    line_memory memory;
} saved_line;

static void save(const line *it, saved_line *to) {
    memset(to->token, 0, sizeof to->token);
    strncpy(to->token, TOKEN, sizeof to->token - 1);
    to->size = sizeof(line_memory);
    to->memory = it->memory;
}

/* false, with a message: it is another line's */
static bool restore(line *it, const saved_line *from) {
    if (from->size != sizeof(line_memory) || strncmp(from->token, TOKEN, sizeof from->token)) {
        snprintf(it->message, MESSAGE, "this state was saved by another model, or on another "
                 "kind of machine");
        return false;
    }
    it->memory = from->memory;
    return true;
}
