/* codemodels/nonsmooth/cfunc.mod - nothing to compute: codemodels/bridge puts its own load in place of
 * the one that would call this. */
void cm_nonsmooth(ARGS)
{
    (void) mif_private;
}
