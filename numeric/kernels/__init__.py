"""How does a bounce become machine code, and how are many particles run through it?"""
