"""One instance of the FMU in FMPy, stepped by hand, alike for both versions of the standard."""

from fmpy import extract, instantiate_fmu, read_model_description


class Instance:
    """An instance in FMPy's own terms, for what `simulate_fmu` does not do."""

    def __init__(self, fmu, folder, interface="CoSimulation", start=None):
        extract(str(fmu), unzipdir=folder)
        self.description = read_model_description(folder)
        self.is_3 = self.description.fmiVersion.startswith("3")
        self.fmu = instantiate_fmu(unzipdir=folder, model_description=self.description, fmi_type=interface)
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}
        if self.is_3:
            self.fmu.enterInitializationMode(startTime=0.0)
        else:
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        for name, value in (start or {}).items():
            self.set(name, value)
        self.fmu.exitInitializationMode()

    def get(self, name):
        read = self.fmu.getFloat64 if self.is_3 else self.fmu.getReal
        return read([self.reference[name]])[0]

    def set(self, name, value):
        write = self.fmu.setFloat64 if self.is_3 else self.fmu.setReal
        write([self.reference[name]], [value])

    def step(self, time, size):
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=size)

    def derivative(self, unknowns, knowns, seed):
        args = ([self.reference[name] for name in unknowns], [self.reference[name] for name in knowns], seed)
        return list(self.fmu.getDirectionalDerivative(*args))

    def save(self):
        return self.fmu.getFMUState() if self.is_3 else self.fmu.getFMUstate()

    def restore(self, state):
        (self.fmu.setFMUState if self.is_3 else self.fmu.setFMUstate)(state)

    def serialized(self, state):
        return (self.fmu.serializeFMUState if self.is_3 else self.fmu.serializeFMUstate)(state)

    def deserialized(self, data):
        return (self.fmu.deserializeFMUState if self.is_3 else self.fmu.deSerializeFMUstate)(data)

    def free(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
