class ForwardAgent(AutonomousAgent):
    ''' Agent that only goes straight '''
    def setup(self):
        ''' Setup the agent '''
        pass

    def run_step(self, sensor_data):
        ''' Executec every tick of the simulation '''
        control = carla.VehicleControl()
        control.throttle = 0.9
        return control

    def config(self):
        ''' Agent, simulation and world config '''
        config = {
            "routes" : "data/route_linden.xml",
            "sensors" : "config/sensors.json",
            "sumo" : "data/sumo//linden",
            "vehicle" : "vehicle.tesla.model3",
            "weather" : "ClearSunset"
        }
        return config

    def get_initial_route_locations(self):
        ''' Get plan '''
        pass
