"""Speed and accuracy of the kernels beside other ways, on labelled cases."""
