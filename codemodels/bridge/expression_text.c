/* bridge/expression_text.c - an expression as a user would write it, for messages.
 *
 * ngspice has rewritten it: a > b became gt0(a-b), numbers are computed. */
#include <stdio.h>
#include <string.h>

#include "expression.h"

#include "ngspice/inpptree.h"

enum { DEPTH = 24 };

typedef struct text_writer {
    char *text;
    size_t size;
    const IFparseTree *tree;
    int depth;
} text_writer;

static void put(text_writer *w, const char *text) {
    const size_t length = strlen(w->text), more = strlen(text);
    if (length + more + 4 < w->size)
        memcpy(w->text + length, text, more + 1);
    else if (length + 4 < w->size && !strstr(w->text, "..."))
        memcpy(w->text + length, "...", 4);
}

static void write_node(text_writer *w, const INPparseNode *node);

static void write_number(text_writer *w, double value) {
    char number[32];
    snprintf(number, sizeof number, "%g", value);
    put(w, number);
}

static void write_variable(text_writer *w, int index) {
    const IFvalue *v = &w->tree->vars[index];
    const int is_current = w->tree->varTypes[index] == IF_INSTANCE;
    const CKTnode *node = is_current ? NULL : (const CKTnode *)v->nValue;
    put(w, is_current ? "i(" : "v(");
    put(w, is_current ? (const char *)v->uValue : node && node->name ? node->name : "?");
    put(w, ")");
}

static void write_pair(text_writer *w, const char *open, const INPparseNode *a, const char *between,
                       const INPparseNode *b) {
    put(w, open);
    write_node(w, a);
    put(w, between);
    write_node(w, b);
    put(w, ")");
}

/* gt0(a-b) as (a>b). */
static int write_comparison(text_writer *w, const INPparseNode *node) {
    static const struct {
        int function;
        const char *sign;
    } of[] = {{PTF_GT0, ">"},  {PTF_LT0, "<"},  {PTF_GE0, ">="},
              {PTF_LE0, "<="}, {PTF_EQ0, "=="}, {PTF_NE0, "!="}};
    for (size_t k = 0; k < sizeof of / sizeof of[0]; k++)
        if (node->funcnum == of[k].function && node->left && node->left->type == PT_MINUS) {
            write_pair(w, "(", node->left->left, of[k].sign, node->left->right);
            return 1;
        }
    return 0;
}

static void write_function(text_writer *w, const INPparseNode *node) {
    if (write_comparison(w, node))
        return;
    put(w, node->funcnum == PTF_UMINUS ? "-" : node->funcname ? node->funcname : "?");
    if (node->left && node->left->type == PT_COMMA) {
        write_pair(w, "(", node->left->left, ",", node->left->right);
        return;
    }
    put(w, "(");
    write_node(w, node->left);
    put(w, node->funcnum == PTF_PWL ? ",...)" : ")");
}

static void write_node(text_writer *w, const INPparseNode *node) {
    static const char *const signs[] = {
        [PT_PLUS] = "+", [PT_MINUS] = "-", [PT_TIMES] = "*", [PT_DIVIDE] = "/", [PT_POWER] = "^"};
    if (!node || w->depth >= DEPTH) {
        put(w, "...");
        return;
    }
    w->depth++;
    if (node->type == PT_CONSTANT)
        write_number(w, node->constant);
    else if (node->type == PT_VAR)
        write_variable(w, node->valueIndex);
    else if (node->type == PT_FUNCTION)
        write_function(w, node);
    else if (node->type >= PT_PLUS && node->type <= PT_POWER)
        write_pair(w, "(", node->left, signs[node->type], node->right);
    else if (node->type == PT_TERN && node->right) {
        put(w, "(");
        write_node(w, node->left);
        write_pair(w, "?", node->right->left, ":", node->right->right);
    } else
        put(w, node->type == PT_TIME ? "time" : node->type == PT_FREQUENCY ? "hertz" : "temper");
    w->depth--;
}

void ns_bridge_expression_text(const IFparseTree *tree, const struct INPparseNode *node, char *text,
                               size_t size) {
    text_writer w = {text, size, tree, 0};
    text[0] = '\0';
    write_node(&w, node);
}
