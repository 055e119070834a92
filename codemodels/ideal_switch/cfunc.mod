/* codemodels/ideal_switch/cfunc.mod - nothing to compute: codemodels/bridge puts its own load in place of
 * the one that would call this, and fills the static variables. */
void cm_ideal_switch(ARGS)
{
    (void) mif_private;
}
