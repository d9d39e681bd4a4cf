//! The help on regions, shown by every command that takes them.

macro_rules! regions_help {
    () => {
        "\
Regions have the weight 0 outside and rise smoothly to 1 inside; lengths are in model units or in % of the diagonal:
  ball:vertex=V,radius=R[,falloff=F]        within R of a vertex along the surface (or of
                                            point=X Y Z: of the place nearest to it)
  stroke:path=X Y Z;X Y Z;…,radius=R        within R of a line over the surface
                                            (or vertices=V V …)
  box:min=X Y Z,max=X Y Z[,falloff=F]       half-space:point=X Y Z,normal=X Y Z[,falloff=F]
  field:name=NAME[,low=A][,high=B]          0 where the field is A, 1 where it is B
                                            (also saliency, mean-curvature, band-3 and other
                                            signals of the shape)
  vertices:indices=V V …[,radius=R]         all of them, or within R of one of them[,falloff=F]
  facing:direction=X Y Z[,falloff=COSINE]   where normals point that way
  component:vertex=V                        the connected component of a vertex
  grown:by=L(REGION)  shrunk:by=L(REGION)   its edge moved by L
  blurred:by=L(REGION)                      its edge softer by L
  !REGION not   REGION & REGION both   REGION | REGION either   0.5*REGION weaker   ( … )
"
    };
}

pub(crate) use regions_help;
